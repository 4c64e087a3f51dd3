"""Examples of fields, parameters and bodies, of the demonstration campaign."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from flexsid.jobs.kinds import ANALYSES

FIELDS: dict[str, Any] = {
    "acceleration": 100.0,
    "against": "dynamic_pressure",
    "aircraft_name": "FLEX-28",
    "airspeed_m_s": 40.0,
    "airspeed_ratio": 0.56,
    "airspeed_std_m_s": 0.3,
    "altitude_m": 1000.0,
    "analysis": 0,
    "approved_by": ["Bo Reviewer"],
    "author": "Ann Analyst",
    "authors": ["Ann Analyst"],
    "axis": "longitudinal",
    "band_hz": [0.25, 6.0],
    "channel": "q",
    "channels": ["bfs", "q"],
    "chord_m": 0.4,
    "code": "not-computed",
    "coefficient": "Cm",
    "columns": 600,
    "cost": -47600.0,
    "damping": 0.7,
    "damping_std": 0.006,
    "deflection": 0.1,
    "degree": 1,
    "deleted_at": None,
    "density_kg_m3": 1.2,
    "derivative": "Cm_q",
    "duration_s": 24.0,
    "dynamic_pressure_pa": 402.0,
    "error": None,
    "file": "recording.csv",
    "flutter_m_s": 59.3,
    "flutter_std_m_s": 0.34,
    "frequency": 18.7,
    "frequency_hz": 2.98,
    "frequency_rad_s": 18.7,
    "frequency_std": 0.04,
    "fta": 506,
    "fuel": 0.5,
    "fuel_fraction": 0.5,
    "g": 0.02,
    "group": "CZ",
    "hash": "5b0c2a...",
    "index": 0,
    "input": "wf4s",
    "inputs": ["bfs"],
    "insensitivity": 0.02,
    "label": "FTA 506, 0.56 Vf",
    "level": 1,
    "limit": 100,
    "load_factor": 0.5,
    "maneuver_label": "1-02 FTA 506",
    "mass_kg": 189.0,
    "max_airspeed_ratio": 1.1,
    "max_fuel": 1.0,
    "mechanism": "flutter",
    "message": "",
    "method": "OE",
    "min_airspeed_ratio": 0.5,
    "min_fuel": 0.0,
    "modes": [7, 9],
    "name": "Cm_alpha",
    "names": ["Cm_alpha", "q"],
    "natural_frequency": 60.0,
    "next": None,
    "next_m_s": 45.0,
    "no_error": None,
    "note": "",
    "number": 9,
    "outcome": "converged",
    "output": "q",
    "outputs": ["q"],
    "peaks": [0.0175, 0.035, 0.07],
    "position": 0.35,
    "probability": 0.97,
    "progress": None,
    "quantities": ["CZ", "etaddot7"],
    "r_squared": 0.99,
    "rate": 2.0,
    "rate_hz": 100.0,
    "reasoning": "SW1T lies above the band of FTA 503",
    "reference_dof": "130+z",
    "refusal": "",
    "response_dof": "1+z",
    "revision": 1,
    "search": "FLEX",
    "seconds": 2.0,
    "sentence": "Flutter of the short period with SW1B at 59.3 ± 0.7 m/s.",
    "since_s": 600.0,
    "sort": "-airspeed_ratio",
    "span_m": 3.0,
    "start_s": 0.0,
    "std_error": 0.0021,
    "std_errors": [0.0021],
    "step_id": 1,
    "stop_s": 5.0,
    "stopped_at": None,
    "surface": "bfs",
    "tags": ["baseline"],
    "tested_m_s": 32.9,
    "time_s": 612.0,
    "undone_at": None,
    "undone_by": None,
    "unit": "rad",
    "upload_id": "5b0c2a",
    "value": -0.252,
    "values": [-0.252],
    "version": 1,
    "warnings": [],
    "worker": "bench/4711",
    "X-Flexsid-Analyst": "Ann%20Analyst",
    # Fields of one schema.
    "Aircraft.name": "FLEX-28",
    "Batch.name": "flight 1",
    "Channel.name": "q",
    "Controller.name": "Pitch damper",
    "ExcitationDesign.name": "FTA 500, first try",
    "Figure.data": [{"type": "scatter", "mode": "lines", "x": [2.0, 4.0], "y": [-0.25, -0.24]}],
    "FlutterSummary.name": "SOL 145",
    "JobItem.kind": "estimation",
    "JobItem.title": "Output error, 1-02 FTA 506",
    "LiveStream.title": "Flight 5",
    "ModalTable.name": "FEM",
    "ModalTableDetail.name": "FEM",
    "ModelProposal.title": "SP + SW1B below 400 Pa",
    "ModelStructure.name": "SP + SW1B",
    "RunItem.state": "succeeded",
    "EstimationRun.state": "succeeded",
    "Pole.name": "SW1B",
    "SavedView.name": "my runs",
    "Sensor.name": "q",
    "SessionState.name": "Ann Analyst",
    "StoredMapping.name": "recorder A",
    "StoredMapping.text": "[aircraft]\n...",
    "StructureVersion.name": "SP + SW1B",
    "Surface.name": "bfs",
    "TokenItem.name": "nightly batch",
    "UploadedFile.name": "recording.csv",
}
"""Examples by the name of a parameter, or of a field of a response; other ids are 1."""

PARAMETERS: dict[str, Mapping[str, Any]] = {
    "find_maneuvers": {"flight_id": 4},
    "list_flight_channels": {"flight_id": 4},
    "cut_maneuver": {"flight_id": 4},
    "draw_flight_history": {"flight_id": 4},
    "draw_bode": {"run_id": "1"},
    "draw_poles": {"run_id": "1"},
    "report_figure": {"figure": "derivatives?run_ids=1"},
    "print_figure": {"figure": "derivatives?run_ids=1"},
    **{
        name: one.example
        for one in ANALYSES
        for name in (f"request_{one.noun}", *one.reading_routes)
    },
}
"""Parameters by operation, where the demonstration campaign needs another value."""

_STRUCTURE = {"modes": [7, 9], "inputs": ["bfs", "wf1s"], "outputs": ["q", "az_egi"]}
_PROPOSAL = {
    "title": "SP + SW1B below 400 Pa",
    "structure": {"id": 1, "version": 1},
    "limits": {"dynamic_pressure_pa": [0.0, 400.0], "fuel_fraction": [0.0, 1.0]},
    "reasoning": "SW1T lies above the band of FTA 503",
    "run_ids": [1],
    "comparisons": [{"run_ids": [1], "prediction_ids": [1], "coefficient": "Cm"}],
}
_GREY_BOX = """from flexsid.sysid import GreyBox, GreyBoxParameter

def roll(p, condition):
    return [[p["L_p"]]], [[p["L_da"]]], [[1.0]], [[0.0]]

MODEL = GreyBox(
    title="Roll mode",
    matrices=roll,
    parameters=[GreyBoxParameter("L_p", -3.0, "1/s"), GreyBoxParameter("L_da", 9.0, "1/s2")],
    inputs={"aileron": "rad"},
    outputs={"p": "rad/s"},
)
"""
_MAPPING = """[aircraft]
builtin = "FLEX-28"
[flight]
number = 12
[time]
column = "t_s"
[[channels]]
column = "bf_sym"
name = "bfs"
unit = "deg"
role = "input"
"""

AIRCRAFT_DEFINITION = """[aircraft]
name = "Kite"
[aircraft.geometry]
area = { value = 11.7, unit = "ft2" }
chord = { value = 1.29, unit = "ft" }
span = { value = 10.0, unit = "ft" }
[aircraft.mass]
fuel = [0.0, 1.0]
mass = { values = [0.40, 0.45], unit = "slug" }
pitch_inertia = { values = [0.33, 0.34], unit = "slug*ft2" }
x_cg = { values = [8.2, 8.3], unit = "in" }
[[aircraft.surfaces]]
name = "bfs"
[[aircraft.sensors]]
name = "q"
kind = "gyro"
"""

BODIES: dict[str, Any] = {
    "start_stream": {
        "run_id": 1,
        "title": "Flight 5",
        "receiver": {"name": "udp", "options": {"port": 5005}},
        "flight_id": 4,
        "next_airspeed_m_s": 52.0,
        "limits": {"az_egi": [-3.0, 1.0]},
    },
    "push_frames": "FXS1...",
    "acknowledge_alarm": {
        "kind": "unstable",
        "subject": "SW1B",
        "time_s": 612.0,
        "note": "excitation stopped",
    },
    "decide_test_point": {"status": "accepted"},
    "request_run": {
        "maneuver_id": 1,
        "method": "OE",
        "structure": {"modes": [7, 9]},
        "settings": {"prior_spread": 0.5},
    },
    "request_batch": {
        "name": "flight 1",
        "maneuver_ids": [1],
        "methods": ["EE", "OE"],
        "structures": [{"structure": {"modes": [7, 9]}}],
        "from_equation_error": True,
    },
    "request_search": {
        "maneuver_ids": [1],
        "method": "EE",
        "structure": {"modes": [7, 9]},
        "settings": {"f_in": 20.0, "f_out": 20.0},
    },
    "add_model_structure": {
        "aircraft_id": 1,
        "name": "SP + SW1B, q and az",
        "structure": _STRUCTURE,
    },
    "edit_model_structure": {"name": "SP + SW1B, q and az", "structure": _STRUCTURE, "version": 1},
    "change_maneuvers": {"ids": [1], "action": "tag", "tag": "questionable"},
    "change_runs": {"ids": [1], "action": "tag", "tag": "baseline"},
    "add_saved_view": {"page": "runs", "name": "my runs", "search": "method=OE"},
    "propose_decision": _PROPOSAL,
    "revise_decision": {"revision": 1, "proposal": _PROPOSAL},
    "comment_decision": {"text": "within 2 σ of zero everywhere", "derivative": "CZ_q"},
    "vote_on_decision": {
        "revision": 1,
        "vote": "approve",
        "text": "agreed",
        "despite": "the runs cover the conditions that are flown next",
    },
    "withdraw_decision": {"revision": 1, "text": "the record was cut wrongly"},
    "add_run_template": {
        "run_id": 1,
        "name": "our standard EE",
        "note": "all flights of the first campaign",
    },
    "edit_run_template": {"run_id": 1, "revision": 1, "note": "with retained modes"},
    "add_note": {
        "subject": "derivative",
        "key": "CZ_q",
        "text": "within **2 σ** of zero everywhere",
        "aircraft_id": 1,
    },
    "edit_note": {"revision": 1, "text": "within **2 σ** of zero below 45 m/s"},
    "change_review_rules": {
        "quorum": 2,
        "own_allowed": False,
        "version": 0,
        "reason": "two pairs of eyes",
    },
    "freeze_figure": {"kind": "spectrum", "query": "maneuver_id=1", "title": "Measured inputs"},
    "create_design": {
        "name": "FTA 500, first try",
        "fta": 500,
        "duration_s": 24.0,
        "rate_hz": 100.0,
        "first_harmonic": 6,
        "peaks": [0.0175, 0.035, 0.07],
        "effort": "quick",
    },
    "add_conditioning": {"items": [{"channel": "q", "kind": "delay", "delay_s": 0.004}]},
    "cut_maneuver": {"label": "4-01 FTA 506", "start_s": 500.0, "stop_s": 530.0, "fta": 506},
    "assess_maneuvers": {"maneuver_ids": [1]},
    "save_global_prediction": {"source": "Global model of flights 1 to 3", "condition": [420.0]},
    "add_global_model_version": {"label": "Flights 1 to 3", "note": "Without the low tanks"},
    "add_aircraft": {"text": AIRCRAFT_DEFINITION},
    "replace_aircraft": {"text": AIRCRAFT_DEFINITION},
    "set_thrust": {
        "engines": ["engine_speed_l", "engine_speed_r"],
        "text": "rpm,280,300\n40000,60,55\n80000,210,190\n",
        "source": "ground run of 2026-05-12",
    },
    "start_design": {
        "name": "about the short period",
        "duration_s": 24.0,
        "rate_hz": 100.0,
        "peaks": [0.0175, 0.035, 0.07],
        "bands": [
            {"name": "bfs", "low_hz": 0.3, "high_hz": 8.0, "count": 20, "targets_hz": [2.3]},
        ],
        "effort": "quick",
    },
    "redesign_phases": {"name": "FTA 500, new phases", "effort": "quick"},
    "save_updated_table": {"name": "FEM updated", "test_ids": [2]},
    "add_write_back": {"run_id": 1, "reason": "consistent with both methods"},
    "compute_prediction": {
        "aircraft_id": 1,
        "source": "Doublet lattice",
        "panels": [
            {
                "left": [0.0, 0.0, 0.0],
                "left_chord": 1.0,
                "right": [0.5, 4.0, 0.0],
                "right_chord": 0.5,
            }
        ],
        "reference_k": 0.2,
    },
    "simulate_design": {"run_id": 1, "level": 1, "controller_id": 1},
    "create_controller": {
        "aircraft_id": 1,
        "name": "Pitch damper",
        "text": '{"reads": ["q"], "drives": ["wf4s"],'
        ' "transfer": {"wf4s": {"q": {"num": [0.2], "den": [0.02, 1.0]}}}}',
    },
    "rescale_design": {"name": "FTA 500, less body flap", "gains": {"bfs": 0.8}},
    "correct_mode": {
        "number": 12,
        "name": "SW2B",
        "symmetric": True,
        "reason": "the winglets move with the second bending mode",
    },
    "import_modal_data": {
        "aircraft_id": 1,
        "name": "FEM 5.1",
        "length_unit": "in",
        "mass_unit": "slinch",
        "fuel": {"empty.op2": 0.0, "full.op2": 1.0},
    },
    "import_responses": {
        "aircraft_id": 1,
        "name": "GVT, empty",
        "response_unit": "g",
        "force_unit": "N",
        "length_unit": "m",
    },
    "estimate_responses": {
        "aircraft_id": 1,
        "name": "GVT, random forces",
        "averages": 40,
        "estimator": "H1",
        "overlap": 0.5,
        "window": "hann",
    },
    "save_identified_modes": {"name": "GVT", "low_hz": 2.0, "high_hz": 18.0, "template_id": 1},
    "request_grey_box_fit": {"maneuver_id": 1, "model": "roll.py", "source": _GREY_BOX},
    "request_orthogonality": {"modal_table_id": 1, "mass": "mass"},
    "import_flutter_summary": {"aircraft_id": 1, "name": "SOL 145", "speed_unit": "kt"},
    "import_mass_properties": {"aircraft_id": 1, "length_unit": "in", "mass_unit": "slinch"},
    "upload_files": {"files": ["recording.csv"]},
    "upload_maneuver": {"files": ["recording.csv"], "mapping": "mapping.toml"},
    "import_multisines": {
        "files": ["commands.csv"],
        "name": "OMS 1",
        "rate_hz": 50.0,
        "unit": "deg",
    },
    "upload_controller": {
        "file": "damper.mat",
        "aircraft_id": 1,
        "name": "Pitch damper",
        "reads": "q",
        "drives": "wf1s,wf4s",
    },
    "log_in": {"name": "Ann Analyst", "password": "correct horse battery staple"},
    "accept_invitation": {"code": "6mD2...", "password": "correct horse battery staple"},
    "change_password": {
        "password": "correct horse battery staple",
        "new_password": "another correct horse battery",
    },
    "set_display_units": {"units": "us", "frequency_unit": "rad/s"},
    "create_token": {"name": "nightly batch", "role": "analyst", "days": 90},
    "add_mapping": {"name": "recorder A", "text": _MAPPING},
    "check_upload": {"mapping": _MAPPING},
    "save_upload_draft": {"mapping": _MAPPING},
    "preview_upload": {"mapping": _MAPPING, "channels": ["bfs"]},
    "import_upload": {"mapping": _MAPPING, "aircraft_id": 1},
}
"""Bodies by operation."""

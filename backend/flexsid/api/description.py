"""The OpenAPI description: that of FastAPI, with error responses and examples added."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fastapi import FastAPI

from flexsid.api import flutter_summary_examples, live_examples
from flexsid.api.permissions import PERMISSIONS

_PROBLEM = "application/problem+json"

EXAMPLES = Path(__file__).with_name("examples.json")
"""Recorded responses by operation; `tests/api/record_examples.py` renews them."""

# Examples by the name of a parameter; ids not listed here are 1.
_EXAMPLES: dict[str, Any] = {
    "aircraft_id": 1,
    "fta": 506,
    "min_airspeed_ratio": 0.5,
    "max_airspeed_ratio": 1.1,
    "min_fuel": 0.0,
    "max_fuel": 1.0,
    "fuel": 0.5,
    "search": "FLEX",
    "sort": "-airspeed_ratio",
    "limit": 100,
    "channels": "bfs,q",
    "output": "q",
    "response_dof": "1+z",
    "reference_dof": "130+z",
    "outputs": "q",
    "inputs": "bfs",
    "modes": "7,9",
    "start_s": 0.0,
    "stop_s": 5.0,
    "coefficient": "Cm",
    "name": "Cm_alpha",
    "names": "Cm_alpha,q",
    "against": "dynamic_pressure",
    "degree": 1,
    "natural_frequency": 60.0,
    "damping": 0.7,
    "position": 0.35,
    "rate": 2.0,
    "acceleration": 100.0,
    "altitude_m": 1000.0,
    "next_m_s": 45.0,
    "deflection": 0.1,
    "load_factor": 0.5,
    "level": 1,
    "upload_id": "5b0c2a",
    "version": 1,
    "revision": 1,
    "step_id": 1,
    "index": 0,
    "group": "CZ",
    "quantities": "CZ,etaddot7",
    "X-Flexsid-Analyst": "Ann%20Analyst",
    "number": 9,
    "airspeed_m_s": 40.0,
    "surface": "bfs",
    "input": "wf4s",
    "since_s": 600.0,
    "columns": 600,
    "analysis": 0,
    "g": 0.02,
}

# Examples by operation, where the demonstration campaign needs another value.
_OPERATION_EXAMPLES: dict[str, dict[str, Any]] = {
    "find_maneuvers": {"flight_id": 4},
    "list_flight_channels": {"flight_id": 4},
    "cut_maneuver": {"flight_id": 4},
    "draw_flight_history": {"flight_id": 4},
    "draw_bode": {"run_id": "1"},
    "draw_poles": {"run_id": "1"},
    **{
        name: {"objective": "flutter", "derivatives": "Cm_alpha,Cm_q", "mode": "7"}
        for name in ("request_optimal_design", "get_optimal_design_job", "get_optimal_design")
    },
}

_STRUCTURE = {"modes": [7, 9], "inputs": ["bfs", "wf1s"], "outputs": ["q", "az_egi"]}
_PROPOSAL = {
    "title": "SP + SW1B below 400 Pa",
    "structure": {"id": 1, "version": 1},
    "limits": {"dynamic_pressure_pa": [0.0, 400.0], "fuel_fraction": [0.0, 1.0]},
    "reasoning": "SW1T lies above the band of FTA 503",
    "run_ids": [1],
    "comparisons": [{"run_ids": [1], "prediction_ids": [1], "coefficient": "Cm"}],
}
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

# Bodies by operation.
_BODIES: dict[str, Any] = {
    **live_examples.BODIES,
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
    "vote_on_decision": {"revision": 1, "vote": "approve", "text": "agreed"},
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

_SESSION = {
    "mode": "team",
    "name": "Ann Analyst",
    "roles": [{"aircraft_id": 1, "role": "analyst"}],
    "expires_at": "2026-11-23T06:00:00Z",
    "units": "metric",
    "frequency_unit": "Hz",
}
_SESSION_ITEM = {
    "id": 1,
    "address": "192.0.2.7",
    "created_at": "2026-11-22T18:00:00Z",
    "used_at": "2026-11-22T19:30:00Z",
    "expires_at": "2026-11-23T06:00:00Z",
    "is_current": True,
}
_TOKEN = {
    "id": 1,
    "name": "nightly batch",
    "role": "analyst",
    "aircraft_id": None,
    "created_at": "2026-11-22T18:00:00Z",
    "expires_at": "2027-02-20T18:00:00Z",
    "used_at": None,
    "secret": None,
}
_AUDIT_EVENT = {
    "number": 1,
    "author": "Ann Analyst",
    "address": "192.0.2.7",
    "request_id": "",
    "operation": "DELETE /api/v1/runs/1",
    "aircraft_id": 1,
    "changes": [
        {
            "table": "runs",
            "action": "update",
            "count": 1,
            "ids": [1],
            "before": "5b0c2a...",
            "after": "91d7e0...",
        }
    ],
    "previous_hash": "",
    "sealed": "{...}",
    "hash": "c03f1b...",
    "created_at": "2026-11-22T18:00:00Z",
    "id": 1,
}
_GLOBAL_MODEL = {
    "sentence": "44 derivatives from 39 runs of 12 flights. Predicted by the other flights, "
    "95 % of the estimates are within 2σ (rms 1.01). Excluded as outlying: run 17.",
    "aircraft_id": 1,
    "modes": [7, 9],
    "variables": [
        {"quantity": "dynamic_pressure_pa", "lowest": 310.0, "highest": 890.0},
        {"quantity": "fuel_fraction", "lowest": 0.1, "highest": 0.9},
    ],
    "centre": [604.0, 0.52],
    "n_maneuvers": 40,
    "n_flights": 12,
    "prediction_id": None,
    "uses_prediction": False,
    "derivatives": [
        {
            "name": "Cm_alpha",
            "label": "Cmα",
            "unit": "1",
            "n_runs": 39,
            "value": -0.252,
            "std_error": 0.0021,
            "scatter": 0.0034,
            "modal_std": 0.0,
            "slopes": [
                {
                    "quantity": "dynamic_pressure_pa",
                    "slope": 2.1e-5,
                    "std_error": 4.0e-6,
                    "probability": 1.2e-5,
                    "is_drift": True,
                }
            ],
        }
    ],
    "scores": [
        {
            "uses_prediction": False,
            "degree": 1,
            "log_density": -1.31,
            "rms": 1.01,
            "share_inside": 0.95,
            "is_selected": True,
        }
    ],
    "outliers": [
        {
            "run_id": 17,
            "label": "FTA 506, 0.71 Vf",
            "sentence": "OE run 17 (FTA 506, 0.71 Vf) differs from the prediction by all "
            "other runs: Cm_wf4s +24.1σ, CZ_wf4s +19.7σ, CQ7_wf4s -12.0σ. A factor of "
            "-1.01 ± 0.04 on all derivatives of wf4s explains 97 % of the deviation: check the "
            "sign of wf4s.",
            "chi_square": 1204.0,
            "n_derivatives": 44,
            "probability": 1e-12,
            "factor": -1.01,
            "factor_std": 0.02,
        }
    ],
    "runs": [
        {
            "run_id": 1,
            "maneuver_id": 1,
            "label": "FTA 506, 0.56 Vf",
            "method": "OE",
            "condition": [402.0, 0.5],
            "is_outlying": False,
        }
    ],
    "next_condition": {"condition": [890.0, 0.9], "reduction": 0.08},
    "omitted": [],
}
_GLOBAL_FIGURE = {
    "data": [{"type": "scatter", "mode": "lines", "x": [310.0], "y": [-0.25]}],
    "layout": {},
}


def _describe_queued_job(kind: str, title: str, request: dict[str, Any]) -> dict[str, Any]:
    return {
        "id": 61,
        "kind": kind,
        "title": title,
        "run_id": None,
        "maneuver_id": None,
        "method": None,
        "request": request,
        "result": None,
        "state": "queued",
        "attempt": 0,
        "priority": 0,
        "position": 1,
        "after_job_id": None,
        "progress": None,
        "error": None,
        "worker": None,
        "author": "Ann Analyst",
        "created_at": "2026-11-22T18:00:00Z",
        "started_at": None,
        "finished_at": None,
    }


_GLOBAL_MODEL_JOB = _describe_queued_job(
    "global-model",
    "40 runs",
    {
        "run_ids": [1, 2, 3, 4],
        "variables": ["dynamic_pressure_pa", "fuel_fraction"],
        "prediction_id": None,
    },
)
_OPTIMAL_DESIGN_JOB = _describe_queued_job(
    "optimal-design",
    "FTA 506",
    {
        "design_id": 1,
        "run_id": 1,
        "level": 0,
        "objective": "flutter",
        "derivatives": [],
        "mode": None,
        "other_run_id": None,
        "deflection": None,
        "rate": None,
        "load_factor": None,
        "spread": 0.1,
        "after_run": False,
    },
)
_AERODYNAMICS_JOB = _describe_queued_job("aerodynamics-comparison", "run 1", {"run_id": 1})
_AERODYNAMICS_FIT = {
    "aerodynamics": "shaped",
    "outcome": "converged",
    "cost": -135711.0,
    "held_out": 420.2,
    "lag_p": 0.47,
    "lag_rejects": False,
    "smallest_r_squared": 0.903,
    "flutter_m_s": 63.87,
    "flutter_std_m_s": 0.33,
    "flutter": "Flutter of the short period with SW1B at 63.87 ± 0.66 m/s, 16.95 rad/s.",
}
_POSTERIOR_JOB = _describe_queued_job("posterior-check", "run 1", {"run_id": 1})
_COMPATIBILITY_JOB = _describe_queued_job("compatibility", "FTA 506", {"maneuver_ids": [1]})
_TRANSFER_FUNCTION_JOB = _describe_queued_job(
    "transfer-function", "q over wf4s, FTA 506", {"maneuver_id": 1, "input": "wf4s", "output": "q"}
)
# Routes that respond as another one, whose example is recorded.
_SAME_RESPONSE = {"replace_aircraft": "add_aircraft", "import_mass_properties": "get_aircraft"}

_GLOBAL_MODEL_VERSION = {
    "aircraft_id": 1,
    "axis": "longitudinal",
    "version": 2,
    "label": "Flights 1 to 3",
    "note": "Without the low tanks",
    "author": "Ann",
    "sentence": "44 derivatives from 4 runs of 3 flights.",
    "variables": ["dynamic_pressure_pa"],
    "prediction_id": None,
    "runs": [
        {
            "run_id": 3,
            "hash": "1f0c4f3a8e2d5b6a7c8d9e0f1a2b3c4d5e6f708192a3b4c5d6e7f8091a2b3c4d",
            "is_outlying": False,
        }
    ],
    "result": "de9fc7603147db7a68ffc986d6538de84ee695ba8227fae993bc00953d48b9e5",
    "created_at": "2026-05-13T09:21:00Z",
    "id": 2,
}
_REVIEWED_GLOBAL_MODEL = {**_GLOBAL_MODEL_VERSION, "decision_id": 4, "state": "approved"}
_GLOBAL_MODEL_SUMMARY = {
    "sentence": "44 derivatives from 4 runs of 3 flights.",
    "aircraft_id": 1,
    "modes": [7, 9],
    "variables": [{"quantity": "dynamic_pressure_pa", "lowest": 210.0, "highest": 640.0}],
    "centre": [415.0],
    "n_maneuvers": 4,
    "n_flights": 3,
    "prediction_id": None,
    "uses_prediction": False,
    "derivatives": [
        {
            "name": "Cm_alpha",
            "label": "C_mα",
            "unit": "1",
            "n_runs": 4,
            "value": -1.31,
            "std_error": 0.021,
            "scatter": 0.012,
            "modal_std": 0.0,
            "slopes": [
                {
                    "quantity": "dynamic_pressure_pa",
                    "slope": 0.00011,
                    "std_error": 0.00009,
                    "probability": 0.4,
                    "is_drift": False,
                }
            ],
        }
    ],
    "scores": [
        {
            "uses_prediction": False,
            "degree": 1,
            "log_density": 3.1,
            "rms": 1.05,
            "share_inside": 0.95,
            "is_selected": True,
        }
    ],
    "outliers": [],
    "runs": [
        {
            "run_id": 3,
            "maneuver_id": 1,
            "label": "1-01 FTA 503",
            "method": "OE",
            "condition": [415.0],
            "is_outlying": False,
        }
    ],
    "next_condition": {"condition": [640.0], "reduction": 0.08},
    "omitted": [],
}

_PRINTED = {
    "id": 21,
    "kind": "report",
    "title": "Output error, run 3",
    "run_id": None,
    "maneuver_id": None,
    "method": None,
    "request": {"name": "flexsid-run-3", "document": 8 * "5f3c1a90"},
    "result": {"name": "flexsid-run-3", "content": 8 * "b20d774e", "n_bytes": 412_310},
    "state": "succeeded",
    "attempt": 1,
    "priority": 0,
    "position": None,
    "after_job_id": None,
    "progress": None,
    "error": None,
    "worker": "bench/4711",
    "author": "Ann Analyst",
    "created_at": "2026-11-23T19:22:31.243964Z",
    "started_at": "2026-11-23T19:22:31.252103Z",
    "finished_at": "2026-11-23T19:22:34.871210Z",
}

_BACKUP = {
    **_PRINTED,
    "kind": "backup",
    "title": "Database",
    "request": {},
    "result": {"name": "20261123-192231-21-1.db", "n_bytes": 73_400_320},
}

# Responses that a server with the demonstration campaign cannot give.
_NOT_RECORDED: dict[str, Any] = {
    **dict.fromkeys((name for name in PERMISSIONS if name.startswith("print_")), _PRINTED),
    "request_backup": _BACKUP,
    **live_examples.RESPONSES,
    **flutter_summary_examples.RESPONSES,
    "list_global_model_versions": {"items": [_REVIEWED_GLOBAL_MODEL]},
    "add_global_model_version": _GLOBAL_MODEL_VERSION,
    "get_global_model_version": {**_REVIEWED_GLOBAL_MODEL, "summary": _GLOBAL_MODEL_SUMMARY},
    "compare_global_models": {
        "before_id": 1,
        "after_id": 2,
        "variables_before": ["dynamic_pressure_pa"],
        "variables_after": ["dynamic_pressure_pa"],
        "added_run_ids": [3],
        "removed_run_ids": [],
        "changed_run_ids": [],
        "outlying_before": [],
        "outlying_after": [],
        "derivatives": [
            {
                "name": "Cm_alpha",
                "before": -1.29,
                "before_std": 0.028,
                "after": -1.31,
                "after_std": 0.021,
            }
        ],
    },
    "list_uploads": {
        "items": [
            {
                "id": "u5b0c2a9e41d7f360",
                "files": ["flight12.csv"],
                "changed_at": "2026-05-12T09:41:07Z",
            }
        ]
    },
    "request_optimal_design": _OPTIMAL_DESIGN_JOB,
    "get_optimal_design_job": {"job": _OPTIMAL_DESIGN_JOB},
    "get_optimal_design": {
        "quantity": "standard error of the flutter speed",
        "unit": "m/s",
        "standard": 0.0681,
        "optimal": 0.0405,
        "duration_s": 24.0,
        "standard_time_s": 92.9,
        "limits": [
            {"name": "load_factor", "limit": 0.661, "standard": 0.661, "optimal": 0.558},
        ],
        "optimal_design_id": 2,
    },
    "request_compatibility": _COMPATIBILITY_JOB,
    "get_compatibility_job": {"job": _COMPATIBILITY_JOB},
    "get_compatibility": {
        "maneuver_ids": [1],
        "state": "faulty",
        "sentence": "alpha is recorded 22.03 ± 0.35 ms late.",
        "faults": [
            {
                "finding": {
                    "kind": "delay",
                    "channel": "alpha",
                    "axis": "",
                    "value": 0.02203,
                    "std": 0.00035,
                    "gain": 15089.0,
                    "sentence": "alpha is recorded 22.03 ± 0.35 ms late.",
                    "remedy": "Correct the delay of alpha, or declare it in its instrument.",
                    "correction": {
                        "channel": "alpha",
                        "kind": "delay",
                        "delay_s": 0.02203,
                        "scale": 1.0,
                        "bias": 0.0,
                        "stretches": [],
                        "std": 0.00035,
                        "basis": "compatibility of the sensors by kinematics",
                        "is_shared": False,
                    },
                },
                "inseparable": [],
                "question": "",
            }
        ],
        "sensors": [
            {
                "name": "alpha",
                "kind": "vane",
                "delay_s": 0.02203,
                "delay_std_s": 0.00035,
                "scale": 1.002,
                "scale_std": 0.0057,
                "arm_axis": "x",
                "arm_m": 0.002,
                "arm_std_m": 0.005,
                "misfit": 1.1,
                "coherence": 0.9998,
                "not_checked": None,
            }
        ],
        "band_hz": [0.05, 6.5],
        "n_frequencies": 129,
    },
    "request_transfer_function": _TRANSFER_FUNCTION_JOB,
    "get_transfer_function_job": {"job": _TRANSFER_FUNCTION_JOB},
    "get_transfer_function": {
        "maneuver_id": 1,
        "input": "wf4s_command",
        "output": "q",
        "n_zeros": 1,
        "n_poles": 2,
        "integrators": 0,
        "has_delay": True,
        "band_hz": [0.375, 1.83],
        "n_frequencies": 8,
        "gain": -26.3,
        "gain_std": 0.914,
        "delay_s": 0.0636,
        "delay_std_s": 0.00357,
        "numerator": [-60.2, -26.3],
        "denominator": [64.6, 5.85, 1.0],
        "zeros": [
            {
                "real_rad_s": -2.29,
                "imag_rad_s": 0.0,
                "frequency_rad_s": 2.29,
                "frequency_std_rad_s": 0.222,
                "damping": 1.0,
                "damping_std": 0.0,
            }
        ],
        "poles": [
            {
                "real_rad_s": -2.93,
                "imag_rad_s": 7.49,
                "frequency_rad_s": 8.04,
                "frequency_std_rad_s": 0.0642,
                "damping": 0.364,
                "damping_std": 0.0127,
            }
        ],
        "mismatch": 0.0,
        "mismatch_cost": 2.67,
        "cost_beyond_noise": 0.0,
        "is_close": True,
        "sentence": "q over wf4s_command: mismatch cost 2.67, 0 beyond noise (below 10 is close): "
        "a close match.",
        "warnings": [],
    },
    "request_posterior_check": _POSTERIOR_JOB,
    "get_posterior_check_job": {"job": _POSTERIOR_JOB},
    "get_posterior_check": {
        "run_id": 1,
        "is_confirmed": True,
        "is_converged": True,
        "sentence": "The standard errors hold beyond first order. Standard deviations of ...",
        "n_chains": 4,
        "n_samples": 200,
        "acceptance": 0.99,
        "parameters": [
            {
                "name": "CZ_alpha",
                "unit": "",
                "value": -4.67,
                "std_error": 0.019,
                "ratio": 1.01,
                "ratio_error": 0.03,
                "low": -4.709,
                "high": -4.633,
                "scale_reduction": 1.0,
                "sample_size": 760.0,
            }
        ],
        "poles": [],
        "flutter": None,
    },
    "request_aerodynamics_comparison": _AERODYNAMICS_JOB,
    "get_aerodynamics_comparison_job": {"job": _AERODYNAMICS_JOB},
    "get_aerodynamics_comparison": {
        "run_id": 1,
        "verdict": "shaped",
        "sentence": "The forces lag the motion: with the frequency shape of Doublet lattice ...",
        "source": "Doublet lattice",
        "prediction_id": 2,
        "n_frequencies": 325,
        "n_held_out": 108,
        "highest_k": 0.95,
        "difference": 4650.0,
        "difference_std": 156.0,
        "fits": [
            {
                **_AERODYNAMICS_FIT,
                "aerodynamics": "quasi-steady",
                "cost": -119824.0,
                "held_out": 377.2,
                "lag_p": 1.2e-120,
                "lag_rejects": True,
                "smallest_r_squared": 0.879,
                "flutter_m_s": 93.65,
                "flutter_std_m_s": 1.33,
                "flutter": "Flutter of the short period with SW1B at 93.65 ± 2.66 m/s.",
            },
            _AERODYNAMICS_FIT,
        ],
    },
    "save_updated_table": {
        "aircraft_id": 1,
        "name": "FEM updated",
        "kind": "FEM",
        "fuel": [0.5],
        "numbers": [7],
        "names": ["SW1B"],
        "symmetric": [True],
        "points": ["egi"],
        "gauges": [],
        "arrays": {"omega": "d6313962...", "zeta": "77bd2a19..."},
        "origin": "FEM updated from GVT",
        "version": 1,
        "reasons": [""],
        "notes": ["SW1B: 2.31 Hz of the GVT (2.43 Hz before)"],
        "id": 3,
    },
    "get_global_model": _GLOBAL_MODEL,
    "save_global_prediction": {
        "aircraft_id": 1,
        "source": "Global model at 520 Pa",
        "kind": "flight",
        "fuel": [0.1, 0.5, 0.9],
        "names": ["CZ_alpha", "Cm_alpha"],
        "values": "5f1c0a2e...",
        "std_errors": "b07de411...",
        "note": "global model at dynamic_pressure_pa = 520 of runs 1, 2, 3, 4",
        "unsteady": None,
        "id": 3,
    },
    "get_global_model_job": {"job": None},
    "request_global_model": _GLOBAL_MODEL_JOB,
    "draw_transfer_function": {
        "data": [{"type": "scatter", "mode": "markers", "x": [0.5], "y": [-3.1]}],
        "layout": {},
    },
    "draw_global_slice": _GLOBAL_FIGURE,
    "draw_global_coverage": _GLOBAL_FIGURE,
    "get_session": _SESSION,
    "log_in": _SESSION,
    "list_audit_events": {"items": [_AUDIT_EVENT], "next": None},
    "list_sessions": {"items": [_SESSION_ITEM]},
    "list_tokens": {"items": [_TOKEN]},
    "create_token": {**_TOKEN, "secret": "flexsid_8Jq0..."},
}

# Beginnings of text responses; binary formats have no example.
_TEXTS = {
    "text/csv": "frequency_hz,bfs,wf1s\n0.25,1.02,0.44\n",
    "text/html": "<!doctype html>\n<title>Run 1, output error</title>\n",
    "application/xml": "<?xml version='1.0'?>\n<DAVEfunc xmlns=\"http://daveml.org/2010/DAVEML\">\n",
    "text/markdown": "# SP + SW1B below 400 Pa\n\n- proposed by Ann Analyst\n",
    "text/plain": "static const float design_t[2400][5] = {\n",
    "text/event-stream": 'id: 12\nevent: job\ndata: {"job_id": 1, "kind": "succeeded"}\n\n',
    "application/zip": "PK",
    "image/svg+xml": "<svg>",
}


def add_examples(app: FastAPI) -> None:
    """Add error responses and examples to the OpenAPI description, once, on first use."""
    generate = app.openapi

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            examples = json.loads(EXAMPLES.read_text(encoding="utf-8"))
            for operation in iterate_operations(generate()):
                _add_request_examples(operation)
                _add_response_examples(operation, examples)
        return generate()

    app.openapi = openapi


def iterate_operations(schema: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield every operation of an OpenAPI description."""
    for methods in schema["paths"].values():
        yield from methods.values()


def _add_request_examples(operation: dict[str, Any]) -> None:
    """Add examples of body and parameters; declare errors as ``application/problem+json``."""
    for status, response in operation["responses"].items():
        if status.startswith("4") and "application/json" in response["content"]:
            response["content"] = {_PROBLEM: response["content"]["application/json"]}
    for body in operation.get("requestBody", {}).get("content", {}).values():
        if operation["operationId"] in _BODIES:
            body["example"] = _BODIES[operation["operationId"]]
    for parameter in operation.get("parameters", ()):
        if "example" not in parameter and "examples" not in parameter:
            specific = _OPERATION_EXAMPLES.get(operation["operationId"], {})
            example = specific.get(parameter["name"], _find_example(parameter["name"]))
            if example is not None:
                parameter["example"] = example


def _add_response_examples(operation: dict[str, Any], examples: dict[str, Any]) -> None:
    """Add an example to every successful response."""
    for status, response in operation["responses"].items():
        if not status.startswith("2"):
            continue
        for kind, content in response.get("content", {}).items():
            example = _TEXTS.get(kind)
            if kind == "application/json":
                name: str = operation["operationId"]
                example = _NOT_RECORDED.get(name, examples.get(_SAME_RESPONSE.get(name, name)))
            if example is not None:
                content["example"] = example


def _find_example(name: str) -> Any:
    if name in _EXAMPLES:
        return _EXAMPLES[name]
    if name.endswith("_ids"):
        return "1"
    return 1 if name.endswith("_id") else None

"""Examples of the routes of live identification: the demonstration campaign has no stream."""

from __future__ import annotations

from typing import Any

_STREAM = {
    "aircraft_id": 1,
    "run_id": 1,
    "title": "Flight 5",
    "receiver": {"name": "udp", "options": {"port": 5005}},
    "flight_id": 4,
    "next_airspeed_m_s": 52.0,
    "limits": {"az_egi": [-3.0, 1.0]},
    "status": "running",
    "message": "",
    "author": "Ann Analyst",
    "holder": "control-room - 4711 1551868",
    "created_at": "2026-11-22T18:00:00Z",
    "stopped_at": None,
    "id": 1,
}
_ALARM = {
    "kind": "unstable",
    "time_s": 612.0,
    "subject": "SW1B",
    "evidence": "damping ratio -0.051 ± 0.012 (2 sigma) at 18.70 rad/s: negative with "
    "probability 1.00",
}
_STATE = {
    "time_s": 612.0,
    "phase": "excited",
    "maneuver_s": 6.0,
    "lost_frames": 1,
    "late_frames": 0,
    "health": [
        {"name": "q", "missing_s": 0.05, "spikes": 2, "is_frozen": False, "is_excluded": False}
    ],
    "estimate": {
        "time_s": 612.0,
        "duration_s": 6.4,
        "converged": True,
        "modes": [
            {
                "name": "SW1B",
                "frequency": 18.7,
                "frequency_std": 0.04,
                "damping": -0.051,
                "damping_std": 0.006,
                "instability_probability": 1.0,
            }
        ],
        "recent_modes": [],
        "names": ["Cm_alpha"],
        "values": [-0.252],
        "std_errors": [0.0021],
        "flutter_m_s": 59.3,
        "flutter_std_m_s": 0.34,
        "next_point_probability": 0.97,
        "excluded": [],
    },
    "reason": "",
    "alarms": [_ALARM],
}
_POINT = {
    "stream_id": 1,
    "start_s": 606.0,
    "stop_s": 630.0,
    "status": "accepted",
    "maneuver_id": 28,
    "run_id": 61,
    "message": "",
    "author": "Ann Analyst",
    "created_at": "2026-11-22T18:00:34Z",
    "id": 1,
}
_ACKNOWLEDGEMENT = {
    "stream_id": 1,
    "kind": "unstable",
    "subject": "SW1B",
    "time_s": 612.0,
    "author": "Ann Analyst",
    "note": "excitation stopped",
    "created_at": "2026-11-22T18:00:08Z",
    "id": 1,
}

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
}

RESPONSES: dict[str, Any] = {
    "draw_live_bode": {
        "data": [{"type": "scatter", "mode": "markers", "x": [2.97], "y": [-12.4]}],
        "layout": {},
    },
    "draw_live_history": {
        "data": [{"type": "scatter", "mode": "markers", "x": [3605.0], "y": [61.2]}],
        "layout": {},
    },
    "list_receivers": {
        "items": [
            {
                "name": "replay",
                "label": "Replay of a maneuver",
                "missing_extra": None,
                "options": [
                    {
                        "name": "maneuver_id",
                        "type": "integer",
                        "description": "Maneuver to replay.",
                        "default": None,
                        "is_required": True,
                    }
                ],
            }
        ]
    },
    "list_streams": {"items": [_STREAM]},
    "start_stream": _STREAM,
    "stop_stream": {**_STREAM, "status": "stopped", "stopped_at": "2026-11-22T19:00:00Z"},
    "push_frames": {"frames": 2},
    "get_stream": {
        "stream": _STREAM,
        "header": {
            "channels": [{"name": "q", "unit": "rad/s", "role": "output", "rate_hz": 1000.0}],
            "frame_s": 0.05,
        },
        "packet_bytes": 216,
        "outputs": ["q"],
        "inputs": ["wf4s"],
        "default_channels": {
            "inputs": ["wf4s"],
            "outputs": ["q"],
            "rates": ["q"],
            "combinations": [],
        },
        "snapshot": {
            "stream_id": 1,
            "state": _STATE,
            "newest_s": 612.4,
            "silent_s": 0.02,
            "delay_s": 0.03,
            "estimate_age_s": 0.4,
            "reception": {
                "is_connected": None,
                "connection_error": "",
                "interruptions": 0,
                "interrupted_s": 0.0,
                "rejected": 2,
                "rejection": "12 bytes are not whole packets of this stream, of 216 bytes each",
                "lost_messages": 0,
            },
        },
        "test_points": [_POINT],
        "alarms": _STATE["alarms"],
        "acknowledgements": [_ACKNOWLEDGEMENT],
        "expected_std_errors": {"Cm_alpha": 0.0011},
    },
    "get_stream_samples": {
        "names": ["q"],
        "units": ["rad/s"],
        "column_s": 0.05,
        "time_s": [612.3, 612.35],
        "low": [[-0.01, -0.02]],
        "high": [[0.02, 0.01]],
    },
    "get_stream_history": {
        "states": [{"stream_id": 1, "time_s": 612.0, "state": _STATE, "delay_s": 0.4, "id": 1}],
        "more": False,
    },
    "acknowledge_alarm": _ACKNOWLEDGEMENT,
    "decide_test_point": _POINT,
}

"""Examples of the routes of flutter summaries: the demonstration campaign has no printout."""

from __future__ import annotations

from typing import Any

_POINT = {
    "root": 4,
    "airspeed_m_s": 59.4,
    "omega_rad_s": 24.6,
    "kind": "flutter",
    "is_bound": False,
    "analysis": "subcase 1, Mach 0, density ratio 1, PK",
    "mach": 0.0,
    "density_ratio": 1.0,
}
_ANALYSIS = {
    "title": "subcase 1, Mach 0, density ratio 1, PK",
    "file": "sol145.f06",
    "subcase": 1,
    "configuration": "AEROSG2D",
    "symmetry": "",
    "method": "PK",
    "mach": [0.0, 0.0],
    "density_ratio": [1.0, 1.0],
}
_SUMMARY = {
    "aircraft_id": 1,
    "name": "SOL 145",
    "points": [_POINT],
    "analyses": [_ANALYSIS],
    "arrays": {"analysis": "7be1d0", "root": "5f2d0c", "airspeed": "a81c3e", "damping": "0d44b7"},
    "notes": ["Velocities are in kt."],
    "origin": "sol145.f06",
    "id": 1,
}
_ROOT = {
    "number": 4,
    "name": "SW1B",
    "is_neutral": False,
    "airspeed_m_s": [57.0, 61.0],
    "damping_g": [-0.012, 0.008],
    "frequency_hz": [3.95, 3.89],
}
_CURVE = {
    "type": "scatter",
    "mode": "lines+markers",
    "x": _ROOT["airspeed_m_s"],
    "y": _ROOT["damping_g"],
    "name": "4 SW1B",
}

RESPONSES: dict[str, Any] = {
    "get_flutter_summary": _SUMMARY,
    "import_flutter_summary": _SUMMARY,
    "list_flutter_summaries": {"items": [_SUMMARY], "next": None},
    "get_summary_roots": {
        "summary_id": 1,
        "analysis": _ANALYSIS,
        "g": 0.0,
        "roots": [_ROOT],
        "points": [_POINT],
        "compared": {"density_kg_m3": 1.225, "from_m_s": 57.0, "to_m_s": 61.0},
        "notes": [],
    },
    "draw_flutter_summary": {"data": [_CURVE], "layout": {"meta": {"rows": 4}}},
}

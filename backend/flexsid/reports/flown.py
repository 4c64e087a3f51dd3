"""Flight condition and source files of a maneuver."""

from __future__ import annotations

from flexsid.records.maneuver import Maneuver
from flexsid.reports.content import shown
from flexsid.storage.store import Store


def condition_facts(maneuver: Maneuver) -> tuple[tuple[str, str], ...]:
    """List the flight condition of a maneuver with units."""
    c = maneuver.condition
    ratio = maneuver.airspeed_ratio
    return (
        (
            "Airspeed",
            f"{shown(c.airspeed_m_s, 'm/s')}{'' if ratio is None else f', {ratio:.3f} V/V_f'}",
        ),
        ("Dynamic pressure", shown(c.dynamic_pressure_pa, "Pa")),
        ("Density", shown(c.density_kg_m3, "kg/m3")),
        ("Fuel fraction", f"{c.fuel_fraction:.2f}"),
        ("Mass", shown(c.mass_kg, "kg")),
        ("Pitch inertia", shown(c.pitch_inertia_kg_m2, "kg*m2")),
        ("Angle of attack", shown(c.alpha_rad, "rad")),
        ("Duration", f"{maneuver.duration_s:g} s"),
        ("Flight test aid", "–" if maneuver.fta is None else f"FTA {maneuver.fta}"),
    )


def source_facts(store: Store, maneuver: Maneuver) -> tuple[tuple[str, str], ...]:
    """List the source files of a maneuver with their hashes."""
    found = {maneuver.source_file: maneuver.source_hash}
    for channel in store.channels.find(maneuver_id=maneuver.id):
        found.setdefault(channel.source_file, channel.source_hash)
    files = tuple(
        (f"File of maneuver {maneuver.id}", file if digest is None else f"{file}, SHA-256 {digest}")
        for file, digest in found.items()
        if file is not None
    )
    return files or ((f"Maneuver {maneuver.id}", "simulated, no source file"),)

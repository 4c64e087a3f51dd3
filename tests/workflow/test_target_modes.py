"""A user relies on: all rows of Table 1 reach their target modes on any aircraft in flight."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from file_imports import import_files
from lateral_flying_wing import add_lateral_aircraft, needs_records

from flexsid.demo.campaign import add_aircraft
from flexsid.records.aircraft import Aircraft, DerivativePrediction, Geometry, MassTable
from flexsid.storage.store import Store
from flexsid.sysid.excitation.catalogue import CATALOGUE
from flexsid.sysid.excitation.targets import spread_harmonics
from flexsid.workflow.excitation.excitation_designs import specify_design
from flexsid.workflow.excitation.target_modes import (
    TargetQuery,
    find_row_band,
    list_row_targets,
)

MAEWING1 = Path(__file__).parents[2].parent / "shared/data/maewing1"

# Boeing 747 at Mach 0.8 and 40,000 ft: B. Etkin, L. D. Reid, Dynamics of Flight (1996), Tables
# 6.1 and 7.1, with the poles found there. Lateral moments of inertia in stability axes.
TRANSPORT = {
    "CZ_alpha": -4.920, "CZ_q": -5.921, "Cm_alpha": -1.033, "Cm_q": -23.92,
    "CY_beta": -0.8771, "Cl_beta": -0.2797, "Cl_p": -0.3295, "Cl_r": 0.3040,
    "Cn_beta": 0.1946, "Cn_p": -0.04073, "Cn_r": -0.2737,
}  # fmt: skip


def add_transport(store: Store) -> int:
    aircraft = store.aircraft.add(
        Aircraft(
            name="Transport",
            geometry=Geometry(area_m2=511.0, chord_m=8.324, span_m=59.64),
            mass=MassTable(
                fuel=(0.5,),
                mass_kg=(2.83176e6 / 9.80665,),
                pitch_inertia_kg_m2=(0.449e8,),
                x_cg_m=(0.0,),
                z_cg_m=(0.0,),
                roll_inertia_kg_m2=(0.247e8,),
                yaw_inertia_kg_m2=(0.673e8,),
                product_of_inertia_kg_m2=(-0.212e7,),
            ),
            surfaces=(),
            sensors=(),
            instruments={},
        )
    )
    store.predictions.add(
        DerivativePrediction(
            aircraft_id=aircraft.id or 0,
            source="Etkin",
            kind="simulation",
            fuel=(0.5,),
            names=tuple(TRANSPORT),
            values=store.arrays.put(np.array([list(TRANSPORT.values())])),
        )
    )
    return aircraft.id or 0


def list_by_number(store: Store, query: TargetQuery, period_s: float):
    rows = {row.number: row for row in list_row_targets(store, query, period_s)}
    assert len(rows) == 24
    return rows


def require_reached(store: Store, query: TargetQuery, missing: set[str] | None = None) -> None:
    """Every row reaches its targets at the duration that the list states for it."""
    for number, row in list_by_number(store, query, 24.0).items():
        duration = float(np.ceil(max(row.least_duration_s, row.duration_s)))
        at_least = list_by_number(store, query, duration / CATALOGUE[number].periods)[number]
        assert missing is None or set(row.missing) == missing & set(
            CATALOGUE[number].targets.split()
        )
        for mode in at_least.modes:
            assert at_least.low_hz <= mode.frequency_hz <= at_least.high_hz, (number, mode)
            assert mode.harmonics_per_surface >= 3, (number, duration, mode)
        assert at_least.reaches_targets
        band = find_row_band(store, number, query, duration, 6)
        peaks = (0.01, 0.02, 0.04)
        made = specify_design(
            number, duration, 100.0, band.first, peaks, "quick", 0, band.last, band.bands
        )
        surfaces, _ = CATALOGUE[number].input_names()
        counts = {own.name: len(own.harmonics) for own in made.inputs}
        assert {counts[name] for name in surfaces} == {row.harmonics_per_surface}
        every = [harmonic for own in made.inputs for harmonic in own.harmonics]
        assert len(set(every)) == len(every)


def test_rigid_transport(store: Store):
    query = TargetQuery(aircraft_id=add_transport(store), airspeed_m_s=235.9, altitude_m=10_999.0)
    rows = list_by_number(store, query, 60.0)
    found = {mode.name: mode for row in rows.values() for mode in row.modes}
    hz = {name: 2 * np.pi * mode.frequency_hz for name, mode in found.items()}
    # Etkin's density is 0.3045 kg/m3 at 40,000 ft; this is the tropopause, 0.364 kg/m3.
    assert hz["SP"] == pytest.approx(abs(-0.3717 + 0.8875j), rel=0.12)
    assert hz["DR"] == pytest.approx(0.947, rel=0.12)
    assert hz["RS"] == pytest.approx(0.5625, rel=0.25)
    assert hz["PH"] == pytest.approx(0.0673, rel=0.15)
    assert found["SP"].damping == pytest.approx(0.387, rel=0.12)
    require_reached(store, query, {"LE", "HE"})


def test_flexible_flying_wing_at_its_flutter_speed(store: Store):
    aircraft = add_aircraft(store)
    require_reached(
        store, TargetQuery(aircraft_id=aircraft.id or 0, airspeed_m_s=59.3), {"DR", "RS"}
    )


@needs_records
def test_antisymmetric_modes(store: Store):
    aircraft = add_lateral_aircraft(store)
    query = TargetQuery(aircraft_id=aircraft.id or 0, airspeed_m_s=38.6)
    rows = list_by_number(store, query, 24.0)
    assert {mode.name for mode in rows[536].modes} >= {"DR", "RS", "AW1B", "AW1T"}
    require_reached(store, query)


@pytest.mark.skipif(not MAEWING1.is_dir(), reason="data beside the project")
def test_maewing1(store: Store):
    example = Path(__file__).parents[2] / "examples/maewing1/maewing1.toml"
    names = (
        *("geri_flight_raw.csv", "Geri_Database.mat", "GerimassProp.mat"),
        *("GericoeffsNOM.mat", "geri_coeffsPIDfull.mat"),
    )
    import_files(store, [MAEWING1 / "flight" / name for name in names], example)
    (aircraft,) = store.aircraft.find()
    query = TargetQuery(aircraft_id=aircraft.id or 0, airspeed_m_s=23.0)
    rows = list_by_number(store, query, 12.0)
    bending = next(mode for mode in rows[503].modes if mode.group == "LE")
    assert bending.frequency_hz == pytest.approx(abs(-3.6474 + 41.2803j) / (2 * np.pi), rel=0.1)
    require_reached(store, query, {"DR", "RS"})


def test_harmonics_are_denser_about_targets_and_span_the_band():
    dealt = spread_harmonics(60, 4, 400, [(40.0, 60.0), (200.0, 240.0)], 15)
    assert dealt.size == np.unique(dealt).size == 60
    assert (dealt[0], dealt[-1]) == (4, 400)
    for low, high in ((40, 60), (200, 240)):
        assert np.sum((dealt >= low) & (dealt <= high)) >= 15
    np.testing.assert_array_equal(spread_harmonics(60, 4, 30), 4 + np.arange(60))

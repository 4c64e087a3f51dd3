"""The report of a campaign: what was flown, what was estimated, what the structure did."""

from __future__ import annotations

from typing import Unpack

from flexsid import figures
from flexsid.errors import Conflict
from flexsid.records.ground_test import Verdict
from flexsid.reports.content import Facts, Part, Report, Section, Table, Words, drawn, listed
from flexsid.storage.maneuver_list import ManeuverFilters, ManeuverItem
from flexsid.storage.store import Store
from flexsid.workflow import views
from flexsid.workflow.ground_tests import ground_tests


def campaign_report(store: Store, **filters: Unpack[ManeuverFilters]) -> Report:
    """Report the maneuvers that a list is narrowed to; all by default.

    Raises
    ------
    Conflict
        If there is none.
    """
    flown = store.maneuver_page(limit=None, **filters).items
    if not flown:
        raise Conflict(
            "there is no maneuver to report; import some, or widen the filter", code="no-maneuver"
        )
    aircraft = list(dict.fromkeys(item.aircraft_name for item in flown))
    return Report(
        title=f"Flight test campaign of {listed(aircraft)}",
        subtitle=_counted(flown),
        name="flexsid-campaign",
        sections=(
            Section(
                "Summary",
                (
                    Facts(_summary(flown)),
                    drawn(
                        "Where the maneuvers were flown",
                        lambda: figures.envelope(views.envelope(store, **filters)),
                    ),
                ),
            ),
            Section("Maneuvers", (_maneuvers(flown),)),
            Section("Ground tests", _ground(store, {item.flight_id for item in flown})),
        ),
        provenance=(
            ("Maneuvers", listed(item.id for item in flown)),
            (
                "Narrowed to",
                listed(
                    (f"{k} {v}" for k, v in filters.items() if v not in (None, False)), "nothing"
                ),
            ),
        ),
    )


def _counted(flown: list[ManeuverItem]) -> str:
    flights = {item.flight_id for item in flown}
    runs = sum(item.n_runs for item in flown)
    counts = {"flight": len(flights), "maneuver": len(flown), "run": runs}
    return listed(f"{count} {name}{'' if count == 1 else 's'}" for name, count in counts.items())


def _summary(flown: list[ManeuverItem]) -> tuple[tuple[str, str], ...]:
    speeds = [item.airspeed_m_s for item in flown]
    ratios = [item.airspeed_ratio for item in flown if item.airspeed_ratio is not None]
    fuels = [item.fuel_fraction for item in flown]
    with_runs = sum(item.n_runs > 0 for item in flown)
    return (
        ("Airspeed", f"{min(speeds):.1f} to {max(speeds):.1f} m/s"),
        ("V/V_f", f"{min(ratios):.2f} to {max(ratios):.2f}" if ratios else "–"),
        ("Fuel fraction", f"{min(fuels):.2f} to {max(fuels):.2f}"),
        ("Flight test aids", listed(sorted({item.fta for item in flown if item.fta is not None}))),
        ("Estimated", f"{with_runs} of {len(flown)} maneuvers"),
    )


def _maneuvers(flown: list[ManeuverItem]) -> Table:
    rows = []
    for item in flown:
        latest = (
            f"{method.value} {run.state.value}"
            for method, run in item.runs.items()
            if run is not None
        )
        rows.append(
            (
                item.label,
                str(item.flight_number),
                "–" if item.fta is None else str(item.fta),
                f"{item.airspeed_m_s:.2f}",
                "–" if item.airspeed_ratio is None else f"{item.airspeed_ratio:.3f}",
                f"{item.dynamic_pressure_pa:.0f}",
                f"{item.fuel_fraction:.2f}",
                listed(latest),
            )
        )
    return Table(
        ("maneuver", "flight", "FTA", "V [m/s]", "V/V_f", "q̄ [Pa]", "fuel", "newest runs"),
        tuple(rows),
        "Maneuvers with their flight condition",
    )


def _ground(store: Store, flights: set[int]) -> tuple[Part, ...]:
    found = [test for test in ground_tests(store) if test.flight_id in flights]
    if not found:
        return (Words("No flight has ground records from before and after it."),)
    return (
        *(Words(test.message, warns=True) for test in found if test.verdict is not Verdict.HEALTHY),
        Table(
            ("flight", "verdict", "fuel before", "fuel after", "what was found"),
            tuple(
                (
                    str(test.flight_number),
                    test.verdict.value,
                    f"{test.fuel_before:.2f}",
                    f"{test.fuel_after:.2f}",
                    test.message,
                )
                for test in found
            ),
            "Mini-GVT before and after each flight",
            numbers_from=5,
        ),
    )

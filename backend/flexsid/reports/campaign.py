"""Reports of a campaign and of its global model: maneuvers, estimates, flutter, credibility."""

from __future__ import annotations

from typing import Unpack

from flexsid.errors import Conflict
from flexsid.figures.global_model import draw_coverage, draw_slice
from flexsid.records.global_model import GlobalModelResult, GlobalModelSummary, GlobalModelVersion
from flexsid.records.quality import GroundTestVerdict
from flexsid.records.run import Method, RunState
from flexsid.reports.comparison import list_latest_runs, report_estimates
from flexsid.reports.content import (
    Drawing,
    Facts,
    Part,
    Report,
    ReportTable,
    Section,
    Words,
    converted,
    draw,
    estimate,
    heading,
    listed,
    moment,
    number,
    shown,
)
from flexsid.reports.credibility import report_version_credibility
from flexsid.storage.lists.maneuver_list import LatestRun, ManeuverFilters, ManeuverItem
from flexsid.storage.store import Store
from flexsid.workflow.global_model.versions import (
    compute_coverage,
    find_decision,
    load_result,
    slice_derivative,
)
from flexsid.workflow.quality.ground_records import compare_all_ground_records
from flexsid.workflow.review.evidence import list_software_versions

# --- Report of a campaign: maneuvers, estimates, flutter prediction, ground tests -----------------


def campaign_report(store: Store, **filters: Unpack[ManeuverFilters]) -> Report:
    """Report the maneuvers selected by filters; all by default.

    Raises
    ------
    Conflict
        If there is none.
    """
    flown = store.maneuver_page(limit=None, **filters).items
    if not flown:
        raise Conflict(
            "no maneuver matches the filter; import maneuvers, or widen the filter",
            code="no-maneuver",
        )
    aircraft = list(dict.fromkeys(item.aircraft_name for item in flown))
    return Report(
        title=f"Flight test campaign of {listed(aircraft)}",
        subtitle=_count(flown),
        name="flexsid-campaign",
        sections=(
            Section(
                "Summary",
                (
                    Facts(_summarise(flown)),
                    draw("Flight envelope of the maneuvers", store, "envelope", **filters),
                ),
            ),
            Section("Flights", (_list_flights(store, flown),)),
            Section("Maneuvers", (_list_maneuvers(flown),)),
            *report_estimates(store, flown),
            Section(
                "Ground tests", _summarise_ground_tests(store, {item.flight_id for item in flown})
            ),
        ),
        provenance=(
            ("Maneuvers", listed(item.id for item in flown)),
            (
                "Runs",
                listed(sorted(run.id for item in flown for run in list_latest_runs(item)), "none"),
            ),
            (
                "Software",
                listed(f"{name} {value}" for name, value in list_software_versions().items()),
            ),
            *(
                (f"Only {name.replace('_', ' ')}", str(value))
                for name, value in filters.items()
                if value not in (None, False)
            ),
        ),
    )


def _count(flown: list[ManeuverItem]) -> str:
    flights = {item.flight_id for item in flown}
    runs = sum(item.n_runs for item in flown)
    counts = {"flight": len(flights), "maneuver": len(flown), "run": runs}
    return listed(f"{count} {name}{'' if count == 1 else 's'}" for name, count in counts.items())


def _summarise(flown: list[ManeuverItem]) -> tuple[tuple[str, str], ...]:
    speeds = [item.airspeed_m_s for item in flown]
    ratios = [item.airspeed_ratio for item in flown if item.airspeed_ratio is not None]
    fuels = [item.fuel_fraction for item in flown]
    with_runs = sum(item.n_runs > 0 for item in flown)
    return (
        ("Airspeed", f"{converted(min(speeds), 'm/s', 3)} to {shown(max(speeds), 'm/s', 3)}"),
        ("V/V_f", f"{min(ratios):.2f} to {max(ratios):.2f}" if ratios else "–"),
        ("Fuel fraction", f"{min(fuels):.2f} to {max(fuels):.2f}"),
        ("Flight test aids", listed(sorted({item.fta for item in flown if item.fta is not None}))),
        ("Estimated", f"{with_runs} of {len(flown)} maneuvers"),
    )


def _list_flights(store: Store, flown: list[ManeuverItem]) -> ReportTable:
    rows = []
    for flight in store.flights.find():
        cards = [item for item in flown if item.flight_id == flight.id]
        if not cards:
            continue
        fastest = max(item.airspeed_m_s for item in cards)
        rows.append(
            (
                str(flight.number),
                "–" if flight.flown_on is None else flight.flown_on.isoformat(),
                flight.description or "–",
                str(len(cards)),
                converted(fastest, "m/s", 3),
            )
        )
    return ReportTable(
        ("flight", "flown on", "", "maneuvers", heading("fastest", "m/s")),
        tuple(rows),
        "Flights with the maneuvers of this report",
        numbers_from=3,
    )


def _list_maneuvers(flown: list[ManeuverItem]) -> ReportTable:
    rows = []
    for item in flown:
        rows.append(
            (
                item.label,
                str(item.flight_number),
                "–" if item.fta is None else str(item.fta),
                converted(item.airspeed_m_s, "m/s"),
                "–" if item.airspeed_ratio is None else f"{item.airspeed_ratio:.3f}",
                converted(item.dynamic_pressure_pa, "Pa"),
                f"{item.fuel_fraction:.2f}",
                "–" if item.verdict is None else item.verdict.value,
                listed(_format_method(method, run) for method, run in item.runs.items() if run),
            )
        )
    return ReportTable(
        (
            "maneuver",
            "flight",
            "FTA",
            heading("V", "m/s"),
            "V/V_f",
            heading("q̄", "Pa"),
            "fuel",
            "data",
            "estimated by",
        ),
        tuple(rows),
        "Maneuvers with flight condition, data quality, and latest runs",
    )


def _format_method(method: Method, run: LatestRun) -> str:
    """Format method and state of a run; without the state if it succeeded."""
    return method.value if run.state is RunState.SUCCEEDED else f"{method.value} {run.state.value}"


def _summarise_ground_tests(store: Store, flights: set[int]) -> tuple[Part, ...]:
    found = [test for test in compare_all_ground_records(store) if test.flight_id in flights]
    if not found:
        return (Words("No flight has ground records before and after it."),)
    return (
        *(
            Words(test.message, warns=True)
            for test in found
            if test.verdict is not GroundTestVerdict.HEALTHY
        ),
        ReportTable(
            ("flight", "verdict", "fuel before", "fuel after", "result"),
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


# --- Report of a version of a global model: derivatives over the envelope, score, credibility -----

_MOST_SLICES = 12


def global_model_report(store: Store, global_model_id: int) -> Report:
    """Report a version of a global model.

    Raises
    ------
    UnknownRecord
        If there is none of this id.
    """
    version = store.global_model_versions.get(global_model_id)
    decision = find_decision(store, version)
    result = load_result(store, version)
    summary = result.summary
    aircraft = store.aircraft.get(version.aircraft_id)
    outlying = tuple(Words(one.sentence, warns=True) for one in summary.outliers)
    state = "not proposed" if decision is None else decision.state.value
    return Report(
        title=f"Global model version {version.version}: {version.label}",
        subtitle=f"{version.axis.capitalize()} derivatives of {aircraft.name}, {state}",
        name=f"flexsid-global-model-{global_model_id}",
        sections=(
            Section(
                "Summary",
                (
                    Words(version.sentence),
                    *((Words(version.note),) if version.note else ()),
                    *outlying,
                    Facts(_summarise_model(version, summary, state)),
                ),
            ),
            Section("Derivatives", (_tabulate_derivatives(summary),)),
            Section("Derivatives that vary most", _draw_slices(result)),
            Section(
                "Coverage",
                (
                    Drawing(
                        draw_coverage(compute_coverage(result)),
                        "Standard error over the envelope relative to its smallest, with the runs",
                    ),
                ),
            ),
            Section("Prediction of flights", (_tabulate_scores(summary),)),
            report_version_credibility(store, version, summary, decision),
        ),
        provenance=(
            ("Version", f"{version.version}, stored {moment(version.created_at)}"),
            ("By", version.author or "–"),
            ("SHA-256 of the model", version.result),
            *((f"Run {run.run_id}", run.hash) for run in version.runs),
        ),
    )


def _summarise_model(
    version: GlobalModelVersion, summary: GlobalModelSummary, state: str
) -> tuple[tuple[str, str], ...]:
    ranges = (
        (one.quantity.value, f"{number(one.lowest)} to {number(one.highest)}")
        for one in summary.variables
    )
    return (
        ("Review", state),
        ("Modes", listed(summary.modes, "none: rigid body")),
        *ranges,
        ("Runs", listed(run.run_id for run in version.runs)),
    )


def _tabulate_derivatives(summary: GlobalModelSummary) -> ReportTable:
    rows = []
    for one in summary.derivatives:
        value, error = estimate(one.value, one.std_error)
        drift = listed((s.quantity.value for s in one.slopes if s.is_drift), "–")
        rows.append(
            (one.label, one.name, drift, value, error, number(one.scatter, 2), str(one.n_runs))
        )
    return ReportTable(
        ("", "name", "varies with", "value", "σ", "scatter", "runs"),
        tuple(rows),
        "Values and standard errors σ at the mean condition of the runs, scatter between runs",
        numbers_from=3,
    )


def _draw_slices(result: GlobalModelResult) -> tuple[Drawing, ...]:
    """Draw the derivatives that vary with the first variable, those of the largest ratio first."""
    ordered = sorted(
        result.summary.derivatives,
        key=lambda one: -abs(one.slopes[0].slope) / max(one.slopes[0].std_error, 1e-300),
    )
    return tuple(
        Drawing(
            draw_slice(slice_derivative(result, one.name)),
            f"{one.label} ({one.name}) with ±2 standard errors, others at the mean condition",
        )
        for one in ordered[:_MOST_SLICES]
    )


def _tabulate_scores(summary: GlobalModelSummary) -> ReportTable:
    return ReportTable(
        ("mean of the model", "selected", "degree", "log density", "rms / σ", "within 2σ [%]"),
        tuple(
            (
                "prediction" if one.uses_prediction else "none",
                "yes" if one.is_selected else "no",
                str(one.degree),
                f"{one.log_density:.3f}",
                f"{one.rms:.2f}",
                f"{100.0 * one.share_inside:.0f}",
            )
            for one in summary.scores
        ),
        "Each flight predicted by all others, for each candidate of the model",
        numbers_from=2,
    )

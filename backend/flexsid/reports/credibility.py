"""Credibility sheet of a result: the factors of NASA-STD-7009 with the evidence that is stored.

Sources: NASA-STD-7009A with change 1, Standard for Models and Simulations (2016), appendix E:
data and input pedigree, verification, validation, uncertainty characterization, results
robustness, use history and management; NASA-STD-7009 (2008): people qualifications.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from flexsid.records.decision import Decision
from flexsid.records.global_model import GlobalModelSummary, GlobalModelVersion
from flexsid.records.run import AdequacyState, EstimationRun, OutOfBandModes, RunResult
from flexsid.reports.content import Part, ReportTable, Section, Words, listed
from flexsid.storage.content import find_changes
from flexsid.storage.store import Store
from flexsid.text import count_noun
from flexsid.workflow.model_structures.model_structures import hash_run

BLANK = "NOT STATED"
"""Text of a factor without evidence in the database."""

_NOTE = (
    "Factors of NASA-STD-7009. The evidence is what the database holds; a factor without evidence"
    f" is {BLANK}. Levels 0 to 4 are assessed by the reader for the intended use."
)
_ANALYST = "names are as entered; qualifications of these persons"


def report_run_credibility(store: Store, run: EstimationRun, result: RunResult) -> Section:
    """Report the credibility of a run.

    Parameters
    ----------
    store
        Database.
    run, result
        The run, and its result.
    """
    maneuver_ids = (run.maneuver_id, *run.settings.additional_maneuver_ids)
    decisions = [one for one in store.decisions.find() if run.id in one.proposal.all_run_ids]
    versions = [
        one
        for one in store.global_model_versions.find()
        if any(each.run_id == run.id for each in one.runs)
    ]
    return _build_section(
        data=_describe_data(store, [run], maneuver_ids),
        verification=_describe_software(run.versions),
        validation=_describe_validation(result),
        inputs=_describe_inputs(store, run, result),
        uncertainty=_describe_uncertainty(run, result),
        robustness=_describe_robustness(store, run, result),
        history=[
            *(f"decision {one.id}, {one.state.value}: {one.proposal.title}" for one in decisions),
            *(one.name for one in versions),
        ],
        management=_describe_management(store, run),
        people=[f"estimated by {run.author}"] if run.author else [],
    )


def report_version_credibility(
    store: Store,
    version: GlobalModelVersion,
    summary: GlobalModelSummary,
    decision: Decision | None,
) -> Section:
    """Report the credibility of a version of a global model.

    Parameters
    ----------
    store
        Database.
    version, summary
        The version, and its model.
    decision
        Newest decision about it, if there is one.
    """
    runs = [store.runs.get(one.run_id) for one in version.runs]
    changed = [
        one.run_id for one, run in zip(version.runs, runs, strict=True) if hash_run(run) != one.hash
    ]
    states = Counter(run.result.adequacy.state.value for run in runs if run.result is not None)
    scores = [one for one in summary.scores if one.is_selected]
    modal = sum(one.modal_std > 0.0 for one in summary.derivatives)
    maneuver_ids = tuple(dict.fromkeys(run.maneuver_id for run in runs))
    decided = [] if decision is None else [decision]
    return _build_section(
        data=[
            *_describe_data(store, runs, maneuver_ids),
            f"runs changed since the version was stored: {listed(changed, 'none')}",
        ],
        verification=_describe_software(runs[0].versions),
        validation=[
            f"each flight predicted by all others: {100 * one.share_inside:.0f} % of the estimates"
            f" within 2σ, rms {one.rms:.2f} (1 expected)"
            for one in scores
        ]
        + [f"model adequacy of the runs: {_count(states)}"],
        inputs=[
            f"variables {listed(one.quantity.value for one in summary.variables)}",
            "mean of the model: "
            + (
                store.predictions.get(version.prediction_id).source
                if summary.uses_prediction and version.prediction_id is not None
                else "none"
            ),
            f"modal tables of the runs: {listed(_name_tables(store, runs), 'none')}",
        ],
        uncertainty=[
            f"covariance of {count_noun(len(summary.derivatives), 'derivative')} over the envelope;"
            " extrapolation is marked",
            f"run-to-run scatter estimated; {modal} with an error of the modal table",
            *(
                (f"too few estimates, not in the model: {listed(summary.omitted)}",)
                if summary.omitted
                else ()
            ),
        ],
        robustness=[
            f"outlying runs, excluded: {listed((one.run_id for one in summary.outliers), 'none')}",
            f"{count_noun(len(summary.scores), 'candidate')} of the model compared by the"
            " prediction of flights",
        ],
        history=[f"decision {one.id}, {one.state.value}: {one.proposal.title}" for one in decided],
        management=[
            f"version {version.version}, SHA-256 {version.result}",
            *(f"review: {one.state.value}, revision {one.revision}" for one in decided),
        ],
        people=[
            *((f"stored by {version.author}",) if version.author else ()),
            *(f"{vote.value} by {name}" for one in decided for name, vote in one.votes.items()),
        ],
    )


def _build_section(
    *,
    data: Sequence[str],
    verification: Sequence[str],
    validation: Sequence[str],
    inputs: Sequence[str],
    uncertainty: Sequence[str],
    robustness: Sequence[str],
    history: Sequence[str],
    management: Sequence[str],
    people: Sequence[str],
) -> Section:
    factors = {
        "Data pedigree": data,
        "Verification": [*verification, f"tests of this installation (flexsid verify): {BLANK}"],
        "Validation": validation,
        "Input pedigree": inputs,
        "Uncertainty characterization": uncertainty,
        "Results robustness": robustness,
        "Use history": history,
        "M&S management": management,
        "People qualifications": [*people, f"{_ANALYST}: {BLANK}"],
    }
    table = ReportTable(
        ("factor", "evidence", "level 0 to 4, by the reader"),
        tuple((name, "; ".join(found) or BLANK, "") for name, found in factors.items()),
        "Credibility assessment",
        numbers_from=3,
    )
    parts: tuple[Part, ...] = (Words(_NOTE), table)
    return Section("Credibility", parts)


def _describe_data(
    store: Store, runs: Sequence[EstimationRun], maneuver_ids: Sequence[int]
) -> list[str]:
    maneuvers = [store.maneuvers.get(number) for number in maneuver_ids]
    flights = {maneuver.flight_id for maneuver in maneuvers}
    simulated = sum(maneuver.source_file is None for maneuver in maneuvers)
    qualities = [store.qualities.find(maneuver_id=number) for number in maneuver_ids]
    verdicts = Counter(found[-1].verdict.value if found else "not checked" for found in qualities)
    steps = sum(
        len(store.conditioning.find(maneuver_id=number, undone_at=None)) for number in maneuver_ids
    )
    changes = find_changes(store.database, [run.rests_on for run in runs])
    late = [run.id for run, changed in zip(runs, changes, strict=True) if changed]
    return [
        f"{count_noun(len(runs), 'run')} of {count_noun(len(maneuvers), 'maneuver')} of "
        f"{count_noun(len(flights), 'flight')}",
        f"{simulated} without a source file (simulated)",
        f"quality of the data: {_count(verdicts)}",
        f"{count_noun(steps, 'correction')} of channels",
        f"runs whose data changed since: {listed(late, 'none')}",
    ]


def _describe_software(versions: dict[str, str] | None) -> list[str]:
    return [f"computed by {listed(f'{k} {v}' for k, v in versions.items())}"] if versions else []


def _describe_validation(result: RunResult) -> list[str]:
    adequacy = result.adequacy
    if adequacy.state is AdequacyState.NOT_TESTED:
        return []
    return [
        f"model adequacy: {adequacy.state.value}, {count_noun(len(adequacy.tests), 'test')} for "
        f"remaining model error. {adequacy.reason}"
    ]


def _describe_inputs(store: Store, run: EstimationRun, result: RunResult) -> list[str]:
    prediction = result.prediction_id
    source = "none" if prediction is None else store.predictions.get(prediction).source
    held = f"{count_noun(len(result.held), 'derivative')} held at a fixed value"
    return [
        f"modal tables: {listed(_name_tables(store, [run]), 'none')}",
        f"prediction: {source}",
        held,
    ]


def _name_tables(store: Store, runs: Sequence[EstimationRun]) -> list[str]:
    numbers = {
        number
        for run in runs
        for number in (run.modal_table_id, run.damping_table_id)
        if number is not None
    }
    tables = [store.modal_tables.get(number) for number in sorted(numbers)]
    return [f"{one.name} ({one.kind.value})" for one in tables]


def _describe_uncertainty(run: EstimationRun, result: RunResult) -> list[str]:
    known = sum(one.std_error is not None for one in result.parameters)
    modal = sum(bool(one.modal_std) for one in result.parameters)
    found = [f"standard errors of {known} of {len(result.parameters)} parameters, with covariance"]
    if modal:
        found.append(f"{modal} with an error of the modal table")
    retained = run.settings.out_of_band_modes is OutOfBandModes.RETAINED
    found.append(
        f"out-of-band modes: {'retained as nuisance parameters' if retained else 'omitted'}"
    )
    if run.settings.priors:
        found.append(f"{count_noun(len(run.settings.priors), 'prior')}")
    return found


def _describe_robustness(store: Store, run: EstimationRun, result: RunResult) -> list[str]:
    others = store.runs.find(maneuver_id=run.maneuver_id)
    succeeded = [one for one in others if one.id != run.id and one.result is not None]
    same = [one for one in succeeded if one.structure.modes == run.structure.modes]
    methods = Counter(one.method.value for one in same if one.derived_from_run_id is None)
    refits = sum(one.derived_from_run_id == run.id for one in succeeded)
    found = [f"outcome of the maximisation: {result.fit.outcome}"]
    if methods:
        found.append(f"other runs of the maneuver with these modes: {_count(methods)}")
    if refits:
        found.append(f"{count_noun(refits, 'refit')} with one assumption changed")
    return found


def _describe_management(store: Store, run: EstimationRun) -> list[str]:
    found = [f"run {run.id}, input {run.input_hash or 'not hashed'}, result {run.result_hash}"]
    if run.structure_id is not None:
        name = store.model_structures.get(run.structure_id).name
        found.append(f"model structure {name}, version {run.structure_version}")
    return found


def _count(counts: Counter[str]) -> str:
    return listed((f"{number} {name}" for name, number in counts.items()), "none")

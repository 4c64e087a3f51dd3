"""Write back of the posterior of a run as versions of modal table and prediction, and its undo."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime

import numpy as np

from flexsid.errors import BadInput, Conflict
from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.modal_data import ModalTable
from flexsid.records.run import (
    AdequacyState,
    EstimationRun,
    OutOfBandModes,
    RunPosterior,
    RunResult,
)
from flexsid.records.write_back import WriteBack, WriteBackProposal, WrittenParameter
from flexsid.storage.store import Store
from flexsid.sysid.estimation.experiment import is_shape_error
from flexsid.sysid.estimation.nuisance import PRIOR_SPREAD
from flexsid.sysid.model.derivatives import is_derivative
from flexsid.text import count_noun
from flexsid.workflow.aircraft.derivative_predictions import interpolate_prediction
from flexsid.workflow.aircraft.written_back import read_written_versions
from flexsid.workflow.modal_data.modal_tables import Modes, format_title, open_modes
from flexsid.workflow.modal_data.model_updating import ModeUpdate, read_run_updates, store_updated
from flexsid.workflow.model_structures.model_structures import get_result, hash_run

_KIND = "flight"
_WITHOUT_PREDICTION = "flight"  # name of the first version of an aircraft without a prediction
_VERSION = re.compile(r" \(version (\d+)\)$")

_GROUPS = 2.0
"""Factor of variances where a run estimated frequencies or damping.

Runs use those of a modal table independently of the derivatives, but their errors are correlated:
stiffness in vacuo and in air are seen as their sum. [[A, B], [B^T, D]] is below 2 A and 2 D apart
(2 diag(A, D) - C is C with the signs of B changed, which is positive semidefinite, too)."""


@dataclass(frozen=True, slots=True)
class _Posterior:
    """What a run writes: derivatives and shapes with their covariance, and updates of modes.

    ``held_std`` are standard deviations of derivatives that the covariance does not hold.
    """

    run: EstimationRun
    result: RunResult
    aircraft_id: int
    fuel: float
    modes: tuple[int, ...]
    names: tuple[str, ...]
    values: np.ndarray
    covariance: np.ndarray
    held_std: np.ndarray
    base: DerivativePrediction | None
    table: Modes | None
    updates: dict[int, ModeUpdate]
    maneuver_ids: tuple[int, ...]


def propose_write_back(store: Store, run_id: int) -> WriteBackProposal:
    """Return what a write-back of a run would write; nothing is stored.

    Raises
    ------
    BadInput, Conflict
        As ``write_back``.
    """
    with store.reading():
        found = _read(store, run_id)
        before = {} if found.base is None else interpolate_prediction(store, found.base, found.fuel)
        std = np.hypot(np.sqrt(np.diag(found.covariance)), found.held_std)
        rows = [
            WrittenParameter(
                name=name,
                before=before.get(name, (None, None))[0],
                before_std=before.get(name, (None, None))[1],
                after=float(value),
                after_std=float(own),
            )
            for name, value, own in zip(found.names, found.values, std, strict=True)
            if not is_shape_error(name)
        ]
        table = None if found.table is None else found.table.table
        return WriteBackProposal(
            run_id=run_id,
            sentence=_describe(store, found),
            prediction=_name_version(store, found),
            former_prediction=None if found.base is None else found.base.source,
            modal_table=None if table is None else format_title(_next_version(store, table)),
            former_modal_table=None if table is None else format_title(table),
            maneuver_ids=found.maneuver_ids,
            parameters=(*rows, *_list_mode_rows(found)),
            n_shapes=sum(map(is_shape_error, found.names)),
            warnings=_list_warnings(found),
        )


def write_back(store: Store, run_id: int, reason: str, author: str = "") -> WriteBack:
    """Write the posterior of a run back, as new versions of its modal table and prediction.

    Parameters
    ----------
    store, run_id
        A succeeded run with its retained modes.
    reason
        Of the person who decides.
    author
        That person.

    Returns
    -------
    WriteBack
        The former versions stay, and runs name those that they used.

    Raises
    ------
    BadInput
        If the reason is empty, the run omits modes or has derivatives with a frequency shape: its
        derivatives are then not those of another condition.
    Conflict
        If the run has no result, a parameter without standard error, or is written back already.

    Notes
    -----
    The joint posterior N(m, C) of derivatives, of retained modes too, and of the errors of mode
    shapes at the sensors is stored; another record has it as its prior (``build_written_prior``). A
    derivative d that the former prediction gives over fuel becomes d(f) + m - d(f0) with the
    variance C + s^2 (d(f) - d(f0))^2: its change over fuel is as uncertain as a prediction,
    s = 0.3. Frequencies and damping that the run estimated change the modal table as in
    ``update_modal_table``.
    """
    reason = reason.strip()
    if not reason:
        raise BadInput("the reason is empty; give the reason of the write-back", code="no-reason")
    with store.transaction():
        found = _read(store, run_id)
        sentence = _describe(store, found)
        prediction = _store_prediction(store, found)
        table = None if found.table is None else _store_table(store, found, found.table)
        return store.write_backs.add(
            WriteBack(
                aircraft_id=found.aircraft_id,
                run_id=run_id,
                run_hash=hash_run(found.run),
                reason=reason,
                sentence=sentence,
                maneuver_ids=found.maneuver_ids,
                fuel_fraction=found.fuel,
                modes=found.modes,
                names=found.names,
                values=tuple(found.values.tolist()),
                covariance=store.arrays.put(found.covariance),
                adequacy=found.result.adequacy.state,
                prediction_id=prediction.id or 0,
                former_prediction_id=None if found.base is None else found.base.id,
                modal_table_id=None if table is None else table.id,
                former_modal_table_id=None if found.table is None else found.table.table.id,
                author=author,
            )
        )


def undo_write_back(store: Store, write_back_id: int, author: str = "") -> WriteBack:
    """Undo a write-back: the former versions are the default again, and nothing is deleted.

    Raises
    ------
    Conflict
        If it is undone already.
    """
    with store.transaction():
        found = store.write_backs.get(write_back_id)
        if found.undone_at is not None:
            raise Conflict("this write-back is undone already", code="already-undone")
        now = datetime.now(UTC)
        return store.write_backs.replace(replace(found, undone_at=now, undone_by=author))


def _read(store: Store, run_id: int) -> _Posterior:
    run = store.runs.get(run_id)
    result = get_result(run, "nothing to write back")
    if run.settings.out_of_band_modes is not OutOfBandModes.RETAINED:
        raise BadInput(
            f"run {run_id} omits modes: its derivatives contain their static response at its own "
            "dynamic pressure; estimate again with retained out-of-band modes",
            code="modes-omitted",
            run_id=run_id,
        )
    if run.settings.aerodynamics.is_shaped:
        raise BadInput(
            f"run {run_id} has derivatives with a frequency shape; write back a quasi-steady run",
            code="frequency-shape",
            run_id=run_id,
        )
    posterior = result.posterior
    if posterior is None:
        raise Conflict(
            f"run {run_id} has no joint posterior: a parameter has no standard error, or the run "
            "is of an earlier release; estimate again",
            code="no-posterior",
            run_id=run_id,
        )
    maneuver = store.maneuvers.get(run.maneuver_id)
    written = read_written_versions(store, maneuver.aircraft_id)
    for one in written.write_backs:
        if one.run_id == run_id and one.undone_at is None:
            raise Conflict(
                f"run {run_id} is written back already (write-back {one.id})",
                code="already-exists",
                write_back_id=one.id,
            )
    used = _list_used_predictions(store, run, maneuver.aircraft_id)
    sources = [written.find(prediction_id=one.id) for one in used]
    sources.append(written.find(modal_table_id=run.modal_table_id))
    ids = {run.maneuver_id, *run.settings.additional_maneuver_ids}
    ids |= {number for one in sources if one is not None for number in one.maneuver_ids}
    table = None
    if run.modal_table_id is not None:
        table = open_modes(store, store.modal_tables.get(run.modal_table_id))
    updates = {} if table is None else read_run_updates(store, table, run_id)
    names, values, covariance = _select(store, posterior)
    held = {one.name: one.held_std for one in result.parameters}
    factor = _GROUPS if updates else 1.0
    return _Posterior(
        run=run,
        result=result,
        aircraft_id=maneuver.aircraft_id,
        fuel=maneuver.condition.fuel_fraction,
        modes=posterior.modes,
        names=names,
        values=values,
        covariance=factor * covariance,
        held_std=np.array([held.get(name, 0.0) for name in names]),
        base=max(used, key=lambda one: len({*one.names} & {*names}), default=None),
        table=table,
        updates={number: _widen(one, np.sqrt(factor)) for number, one in updates.items()},
        maneuver_ids=tuple(sorted(ids)),
    )


def _select(
    store: Store, posterior: RunPosterior
) -> tuple[tuple[str, ...], np.ndarray, np.ndarray]:
    """Select derivatives and errors of shapes; what concerns this record alone is marginalised."""
    own = [
        k for k, name in enumerate(posterior.names) if is_derivative(name) or is_shape_error(name)
    ]
    covariance = np.asarray(store.arrays.get(posterior.covariance))
    names = tuple(posterior.names[k] for k in own)
    return names, np.array(posterior.values)[own], covariance[np.ix_(own, own)]


def _widen(update: ModeUpdate, factor: float) -> ModeUpdate:
    return replace(
        update,
        factor_std=None if update.factor_std is None else factor * update.factor_std,
        damping_std=None if update.damping_std is None else factor * update.damping_std,
    )


def _list_used_predictions(
    store: Store, run: EstimationRun, aircraft_id: int
) -> list[DerivativePrediction]:
    known = store.predictions.find(aircraft_id=aircraft_id)
    return [one for one in known if f"prediction {one.id}" in (run.rests_on or {})]


def _store_prediction(store: Store, found: _Posterior) -> DerivativePrediction:
    base = found.base
    fuel = sorted({found.fuel, *(() if base is None else base.fuel)})
    before = [{} if base is None else interpolate_prediction(store, base, one) for one in fuel]
    here = before[fuel.index(found.fuel)]
    derivatives = [
        (name, float(value), float(std))
        for name, value, std in zip(
            found.names,
            found.values,
            np.hypot(np.sqrt(np.diag(found.covariance)), found.held_std),
            strict=True,
        )
        if is_derivative(name)
    ]
    names = tuple(dict.fromkeys((*here, *(name for name, _, _ in derivatives))))
    values, errors = np.full((2, len(fuel), len(names)), np.nan)
    for row, at_fuel in enumerate(before):
        for name, (value, std) in at_fuel.items():
            if name in names:
                values[row, names.index(name)] = value
                errors[row, names.index(name)] = np.nan if std is None else std
        for name, value, std in derivatives:
            change = at_fuel[name][0] - here[name][0] if name in here and name in at_fuel else 0.0
            values[row, names.index(name)] = value + change
            errors[row, names.index(name)] = np.hypot(std, PRIOR_SPREAD * change)
    return store.predictions.add(
        DerivativePrediction(
            aircraft_id=found.aircraft_id,
            source=_name_version(store, found),
            kind=_KIND,
            fuel=tuple(fuel),
            names=names,
            values=store.arrays.put(values),
            std_errors=store.arrays.put(errors),
            note=_describe(store, found),
        )
    )


def _store_table(store: Store, found: _Posterior, modes: Modes) -> ModalTable:
    return store_updated(
        store,
        modes,
        modes.table.name,
        found.updates,
        f"{format_title(modes.table)}, written back from run {found.run.id}",
    )


def _name_version(store: Store, found: _Posterior) -> str:
    """Name the next version of the prediction that the run had."""
    root = _WITHOUT_PREDICTION
    if found.base is not None:
        root = _VERSION.sub("", found.base.source)
    known = [one.source for one in store.predictions.find(aircraft_id=found.aircraft_id)]
    numbers = [
        1 if match is None else int(match[1])
        for source in known
        if _VERSION.sub("", source) == root
        for match in [_VERSION.search(source)]
    ]
    number = 1 + max(numbers, default=0)
    return root if number == 1 else f"{root} (version {number})"


def _next_version(store: Store, table: ModalTable) -> ModalTable:
    known = store.modal_tables.find(aircraft_id=table.aircraft_id, name=table.name)
    return replace(table, version=1 + max(one.version for one in known))


def _list_mode_rows(found: _Posterior) -> Sequence[WrittenParameter]:
    estimated = {one.name: one for one in found.result.parameters}
    return [
        WrittenParameter(
            name=name, before=1.0, before_std=None, after=one.value, after_std=one.std_error or 0.0
        )
        for number in sorted(found.updates)
        for name in (f"omega_{number}", f"zeta_{number}")
        if (one := estimated.get(name)) is not None
    ]


def _list_warnings(found: _Posterior) -> tuple[str, ...]:
    warnings = []
    if found.result.adequacy.state is AdequacyState.SUSPECT:
        warnings.append(
            "The tests for remaining model error reject this run; its standard errors may be too "
            f"small: {found.result.adequacy.reason}"
        )
    return tuple(warnings)


def _describe(store: Store, found: _Posterior) -> str:
    own = {one.name for one in found.result.parameters}
    derivatives = [name for name in found.names if is_derivative(name)]
    retained = sum(name not in own for name in derivatives)
    shapes = sum(map(is_shape_error, found.names))
    parts = [f"{count_noun(len(derivatives) - retained, 'derivative')} of the run"]
    if retained:
        parts.append(f"{retained} of retained modes")
    if shapes:
        parts.append(f"{count_noun(shapes, 'error')} of mode shapes")
    if found.updates:
        parts.append(f"frequency or damping of {count_noun(len(found.updates), 'mode')}")
    maneuvers = ", ".join(map(str, found.maneuver_ids))
    noun = "maneuver" if len(found.maneuver_ids) == 1 else "maneuvers"
    rest = ""
    if found.table is not None and not found.updates:
        rest = " The frequencies and damping of the modal table stay: the run estimated none."
    return (
        f"Posterior of {found.run.method} run {found.run.id} with the data of {noun} {maneuvers}: "
        f"{', '.join(parts)}, as prediction '{_name_version(store, found)}'.{rest}"
    )

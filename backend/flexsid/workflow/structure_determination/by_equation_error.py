"""Model structure determination by equation error over all maneuvers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flexsid.errors import NotIdentifiable
from flexsid.records.run import Progress
from flexsid.records.search import Algorithm, TermGroup
from flexsid.sysid.estimation.equation_error import equation_error
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.structure_determination.equation import compute_equation_evidence
from flexsid.sysid.structure_determination.evidence import Evidence
from flexsid.sysid.structure_determination.likelihood import select_candidates
from flexsid.sysid.structure_determination.search import StructureSelection, search_equations
from flexsid.sysid.structure_determination.selection import Selection
from flexsid.sysid.structure_determination.stability import compute_selection_frequency
from flexsid.workflow.runs.computation import (
    get_first_start,
    reconstruct_with_out_of_band_modes,
    select_free_parameters,
    warn_of_sensor_noise,
)
from flexsid.workflow.structure_determination.task import FittedCandidate, Report, SearchTask
from flexsid.workflow.structure_determination.terms import build_term_group


class EquationSearch:
    """Model structure determination by equation error over all maneuvers."""

    def __init__(self, task: SearchTask, report: Report) -> None:
        self.task = task
        self.candidates: list[Parameters] = []
        self.evidences: list[dict[str, Evidence]] = []
        self.warnings: list[str] = []
        for number, one in enumerate(task.maneuvers):
            data = one.maneuvers[0]
            share = 0.4 * number / len(task.maneuvers)
            report(Progress(fraction=share, message=f"Reconstructing motion in {data.label}"))
            candidates = select_free_parameters(one, get_first_start(one), ())
            motion, _ = reconstruct_with_out_of_band_modes(data)
            self.warnings += warn_of_sensor_noise(data, motion)
            found = compute_equation_evidence(data.model, motion, data.measured.inputs, candidates)
            resolution_overlap = data.measured.resolution_overlap
            self.candidates.append(candidates)
            self.evidences.append(
                {name: e.scale_by_overlap(resolution_overlap) for name, e in found.items()}
            )
        report(Progress(fraction=0.4, message="Selecting terms"))
        self.found = self._search(task.settings.algorithm)

    def _search(self, algorithm: Algorithm) -> StructureSelection:
        return search_equations(self.evidences, algorithm.value, self.task.thresholds)

    def groups(self, report: Report) -> tuple[TermGroup, ...]:
        """Build the terms of every coefficient with their selection frequency."""
        groups, algorithm = [], self.task.settings.algorithm.value
        for number, (name, selection) in enumerate(self.found.coefficients.items()):
            share = 0.45 + 0.35 * number / len(self.found.coefficients)
            report(Progress(fraction=share, message=f"Resampling frequencies for {name}"))
            own = [one[name] for one in self.evidences]

            def select_again(drawn: Sequence[Evidence], name: str = name) -> Selection:
                one = [{name: each} for each in drawn]
                return search_equations(one, algorithm, self.task.thresholds).coefficients[name]

            stability = compute_selection_frequency(own, select_again, self.task.settings.draws)
            groups.append(build_term_group(name, selection, own, stability))
        return tuple(groups)

    def fit(self, warnings: list[str]) -> list[FittedCandidate]:
        """Estimate all terms and the selection of either algorithm by equation error."""
        other = next(one for one in Algorithm if one is not self.task.settings.algorithm)
        selections = {
            self.task.settings.algorithm.value: self.found.selected,
            other.value: self._search(other).selected,
            "all terms": self.candidates[0].names,
        }
        fitted: list[FittedCandidate] = []
        warnings += self.warnings
        for name, selected in selections.items():
            same = next((one for one in fitted if set(one.selected) == set(selected)), None)
            if same is not None:
                fitted[fitted.index(same)] = replace(same, name=f"{same.name}, {name}")
                continue
            try:
                estimates = tuple(
                    self._estimate(one, selected) for one in range(len(self.evidences))
                )
            except NotIdentifiable as reason:
                warnings.append(f"The model structure of {name} has no estimate: {reason.message}.")
                continue
            why = "all candidates" if name == "all terms" else f"selected by {name}"
            fitted.append(FittedCandidate(name, why, selected, estimates, proposed=not fitted))
        if not fitted:
            raise NotIdentifiable(
                "no model structure can be estimated from these maneuvers; free fewer candidates",
                code="empty",
            )
        return fitted

    def _estimate(self, number: int, selected: tuple[str, ...]) -> Estimate:
        data = self.task.maneuvers[number].maneuvers[0]
        candidates = self.candidates[number]
        selected_terms = np.array([name in selected for name in candidates.names])
        if not selected_terms.any():
            raise NotIdentifiable("no candidate term is supported by the data")
        parameters = select_candidates(candidates, selected_terms, candidates.start)
        motion, _ = reconstruct_with_out_of_band_modes(data)
        found = equation_error(data.model, motion, data.measured.inputs, parameters)
        return found.scale_covariance(data.measured.resolution_overlap)

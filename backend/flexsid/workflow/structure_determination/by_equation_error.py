"""A search by equation error: the evidence of every coefficient, over all maneuvers."""

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
from flexsid.sysid.structure_determination.equation import equation_evidence
from flexsid.sysid.structure_determination.evidence import Evidence
from flexsid.sysid.structure_determination.likelihood import reduced
from flexsid.sysid.structure_determination.search import StructureSelection, search_equations
from flexsid.sysid.structure_determination.selection import Selection
from flexsid.sysid.structure_determination.stability import selection_frequency
from flexsid.workflow.runs.computation import any_start, motion_of, parameters_of, remarks_on_motion
from flexsid.workflow.structure_determination.task import Fitted, Report, SearchTask
from flexsid.workflow.structure_determination.terms import term_group


class EquationSearch:
    """The search by equation error over all maneuvers."""

    def __init__(self, task: SearchTask, report: Report) -> None:
        self.task = task
        self.candidates: list[Parameters] = []
        self.evidences: list[dict[str, Evidence]] = []
        self.remarks: list[str] = []
        for number, one in enumerate(task.maneuvers):
            data = one.maneuvers[0]
            share = 0.4 * number / len(task.maneuvers)
            report(Progress(fraction=share, message=f"Reconstructing motion in {data.label}"))
            candidates = parameters_of(one, any_start(one), ())
            motion, _ = motion_of(data)
            self.remarks += remarks_on_motion(data, motion)
            found = equation_evidence(data.model, motion, data.measured.inputs, candidates)
            crowding = data.measured.crowding
            self.candidates.append(candidates)
            self.evidences.append({name: e.thinned(crowding) for name, e in found.items()})
        report(Progress(fraction=0.4, message="Choosing terms"))
        self.found = self._search(task.settings.algorithm)

    def _search(self, algorithm: Algorithm) -> StructureSelection:
        return search_equations(self.evidences, algorithm.value, self.task.thresholds)

    def groups(self, report: Report) -> tuple[TermGroup, ...]:
        """What was found of every coefficient, and how stable the choice is."""
        groups, algorithm = [], self.task.settings.algorithm.value
        for number, (name, selection) in enumerate(self.found.coefficients.items()):
            share = 0.45 + 0.35 * number / len(self.found.coefficients)
            report(Progress(fraction=share, message=f"Drawing lines anew for {name}"))
            own = [one[name] for one in self.evidences]

            def again(drawn: Sequence[Evidence], name: str = name) -> Selection:
                one = [{name: each} for each in drawn]
                return search_equations(one, algorithm, self.task.thresholds).coefficients[name]

            often = selection_frequency(own, again, self.task.settings.draws)
            groups.append(term_group(name, selection, own, often))
        return tuple(groups)

    def fitted(self, warnings: list[str]) -> list[Fitted]:
        """All terms, and what either algorithm chose, each estimated by equation error."""
        other = next(one for one in Algorithm if one is not self.task.settings.algorithm)
        wanted = {
            self.task.settings.algorithm.value: self.found.chosen,
            other.value: self._search(other).chosen,
            "all terms": self.candidates[0].names,
        }
        kept: list[Fitted] = []
        warnings += self.remarks
        for name, chosen in wanted.items():
            same = next((one for one in kept if set(one.chosen) == set(chosen)), None)
            if same is not None:
                kept[kept.index(same)] = replace(same, name=f"{same.name}, {name}")
                continue
            try:
                estimates = tuple(self._estimate(one, chosen) for one in range(len(self.evidences)))
            except NotIdentifiable as reason:
                warnings.append(f"The structure of {name} has no estimate: {reason.message}.")
                continue
            why = "all candidates" if name == "all terms" else f"chosen by {name}"
            kept.append(Fitted(name, why, chosen, estimates, proposed=not kept))
        if not kept:
            raise NotIdentifiable(
                "no structure can be estimated from these maneuvers; free fewer candidates",
                code="empty",
            )
        return kept

    def _estimate(self, number: int, chosen: tuple[str, ...]) -> Estimate:
        data = self.task.maneuvers[number].maneuvers[0]
        candidates = self.candidates[number]
        kept = np.array([name in chosen for name in candidates.names])
        if not kept.any():
            raise NotIdentifiable("nothing in the data asks for any of the candidates")
        parameters = reduced(candidates, kept, candidates.start)
        motion, _ = motion_of(data)
        found = equation_error(data.model, motion, data.measured.inputs, parameters)
        return found.widened(data.measured.crowding)

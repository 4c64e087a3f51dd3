"""RunProposal: a run that suits a maneuver, with the reasons, before anybody asks for one."""

from __future__ import annotations

from dataclasses import dataclass

from flexsid.records.model_structure import Structure
from flexsid.records.proposal_basis import ProposalBasis
from flexsid.records.run import RunSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeInBand:
    """A symmetric mode in the excited band or just above it.

    ``air_frequency_hz`` and ``half_power_hz`` (full width at half power) are predicted at the
    condition of the maneuver; without a prediction the width is that in vacuo.
    """

    number: int
    name: str
    frequency_hz: float
    air_frequency_hz: float | None
    half_power_hz: float
    in_band: bool
    proposed: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class RunProposal:
    """Modes, inputs, outputs, band and options of a run, and its requirements on the data.

    ``inputs`` and ``outputs`` are what the empty ones of the structure stand for;
    ``lines_per_parameter`` counts excited frequencies for each parameter of one equation.
    """

    maneuver_id: int
    basis: ProposalBasis
    structure: Structure
    settings: RunSettings
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    modes: tuple[ModeInBand, ...]
    n_parameters: int
    n_lines: int
    lines_per_input: dict[str, int]
    lines_per_parameter: float
    resolution_hz: float
    warnings: tuple[str, ...]

"""Requirements on the installed software, each with its reference, its test and their report.

Values of flights 41 and 15 are those of AIAA 2015-2704, Table 3, as transcribed by a third party.

https://www.itl.nist.gov/div898/strd: a work of the United States government, in the public domain.
"""

from __future__ import annotations

import json
import platform
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from importlib.resources import files
from typing import Any

import numpy as np

from flexsid.demo.flex28 import load_truth
from flexsid.errors import FlexsidError
from flexsid.records.decision import DecisionEvent, EventKind
from flexsid.reports.content import Facts, Report, ReportTable, Section, Words
from flexsid.storage.audit_recording import hash_value, is_chain_intact, seal
from flexsid.storage.signatures import derive_public_key, is_valid, sign
from flexsid.sysid.aerodynamics.pk_flutter import PkCrossing
from flexsid.sysid.estimation.experiment import select_parameters
from flexsid.sysid.estimation.likelihood import maximize
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.longitudinal import accelerometer_row, gyro_row, vane_row
from flexsid.sysid.model.rigid_body import stack_rows
from flexsid.sysid.modes import StructuralModes
from flexsid.sysid.regression.least_squares import ErrorsInVariables, regress
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.root_tracking import track_roots
from flexsid.verification.published_wings import (
    AGARD_MEASURED,
    GOLAND_EXACT,
    GOLAND_SHARPY,
    HA144A,
    compute_ha144a,
    predict_agard,
    predict_goland_by_lattice,
    predict_goland_by_strips,
)
from flexsid.workflow.fits.estimation_task import read_versions

# --- NASA T-2 (GTM) subscale transport as a rigid aircraft with published derivatives -------------

_FOOT, _SLUG = 0.3048, 14.593902937206364  # m, kg
FLIGHTS: dict[int, dict[str, float]] = {
    41: {"V": 139.1, "rho": 0.0022927, "m": 1.639, "Iyy": 4.651, "natural": 7.112, "zeta": 0.435,
         "CZ_alpha": -3.933, "CZ_q": -15.11, "CZ_de": -0.143,
         "Cm_alpha": -1.667, "Cm_q": -46.36, "Cm_de": -1.676},
    15: {"V": 136.0, "rho": 0.0022765, "m": 1.646, "Iyy": 4.652, "natural": 6.470, "zeta": 0.449,
         "CZ_alpha": -3.828, "CZ_q": -16.39, "CZ_de": -0.125,
         "Cm_alpha": -1.437, "Cm_q": -44.76, "Cm_de": -1.722},
}  # fmt: skip


def build_rigid_model(flight: int) -> tuple[AeroelasticModel, DerivativeTable]:
    """Build the model of a flight and its published derivatives."""
    p = FLIGHTS[flight]
    condition = FlightCondition(
        airspeed=p["V"] * _FOOT,
        density=p["rho"] * _SLUG / _FOOT**3,
        mass=p["m"] * _SLUG,
        pitch_inertia=p["Iyy"] * _SLUG * _FOOT**2,
        area=5.902 * _FOOT**2,
        chord=0.915 * _FOOT,
    )
    none = np.zeros((3, 0))
    origin = (0.0, 0.0, 0.0)
    rows = [
        vane_row((0.5, 0.0, 0.0), none, none, condition),
        gyro_row(none),
        accelerometer_row("z", origin, none, none, condition),
    ]
    empty = np.zeros(0)
    modes = StructuralModes(
        (), empty, empty, empty, (), np.zeros((0, 3, 0)), np.zeros((0, 3, 0)), (), np.zeros((0, 0))
    )
    model = AeroelasticModel(condition, modes, ("de",), stack_rows(("alpha", "q", "az"), rows))
    return model, DerivativeTable.from_names((), ("de",), p)


# --- Linear regressions of the Statistical Reference Datasets of NIST, with certified values ------


def read_data_sets() -> dict[str, Any]:
    """Read all data sets by name."""
    return json.loads(
        files("flexsid.verification").joinpath("nist_linear_regression.json").read_text()
    )


def build_regression(data: dict[str, Any]) -> tuple[np.ndarray, np.ndarray, float]:
    """Build complex data points of two rows each, and the factor on variances that padding adds.

    A complex regression of real parameters is one of twice as many real rows.
    """
    rows = [np.array(row, dtype=float) for row in data["x"]]
    if len(rows) > 1:
        rows_of_x = np.stack([np.ones(rows[0].size), *rows], axis=1)
    else:
        rows_of_x = np.stack([rows[0] ** power for power in data["powers"]], axis=1)
    y = np.array(data["y"], dtype=float)
    n, p = rows_of_x.shape
    if n % 2:
        rows_of_x, y = np.vstack([rows_of_x, np.zeros(p)]), np.append(y, 0.0)
    return rows_of_x[::2] + 1j * rows_of_x[1::2], y[::2] + 1j * y[1::2], (y.size - p) / (n - p)


def count_digits(found: np.ndarray, certified: list[float]) -> float:
    """Count the decimal digits in which the worst value agrees."""
    right = np.array(certified)
    wrong = np.abs(found - right) / np.where(right == 0.0, 1.0, np.abs(right))
    return float(-np.log10(max(wrong.max(), 1e-15)))


# --- Requirements on the installed software, each with its reference and its test -----------------

_FEET = 0.3048  # m
_OMEGA = 2.0 * np.pi * np.linspace(0.2, 2.2, 60)  # rad/s, about the short period of GTM
_AIRSPEEDS = np.linspace(25.0, 95.0, 120)  # m/s
_REPEATS = 40  # of an estimation: their rms deviation over sigma scatters by 1/sqrt(2 * 40 * 6)
_FLUTTER_FT_S = {0.0: 199.00, 0.25: 196.26, 0.5: 194.60, 0.75: 193.47, 1.0: 192.63}
_USUAL_SETS = ("Norris", "Pontius", "NoInt1", "NoInt2", "Longley")
_RFC_SECRET = "4ccd089b28ff96da9db6c346ec114e0f5b8a319f35aba624da8cf6ed4fb8a6fb"
_RFC_PUBLIC = "3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c"
_RFC_SIGNATURE = (
    "92a009a9f0d4cab8720e820b5f642540a2b27b5416503f8fb3762223ebdb69da"
    "085ac1e43e15996e458f3613d0f11d8c387b2eaeb4302aeeb00d291612bb0c00"
)


@dataclass(frozen=True, slots=True)
class Requirement:
    """A requirement that holds if what its test measures is at most ``limit``."""

    id: str
    statement: str
    reference: str
    measure: Callable[[], float]
    limit: float


@dataclass(frozen=True, slots=True)
class Measured:
    """Outcome of the test of a requirement; ``failure`` is the reason without a value."""

    requirement: Requirement
    value: float | None
    failure: str = ""

    @property
    def is_fulfilled(self) -> bool:
        """Whether the value is within the limit."""
        return self.value is not None and self.value <= self.requirement.limit


def measure_requirements(report: Callable[[str], None] = lambda text: None) -> list[Measured]:
    """Test all requirements; one that raises an error is not fulfilled."""
    found: list[Measured] = []
    for requirement in REQUIREMENTS:
        report(requirement.statement)
        try:
            found.append(Measured(requirement, requirement.measure()))
        except (FlexsidError, ArithmeticError, ValueError) as error:
            found.append(Measured(requirement, None, str(error)))
    return found


def _measure_regression() -> float:
    """Largest relative error of coefficients and standard errors, over all usual data sets."""
    sets = read_data_sets()
    return max(_measure_data_set(sets[name]) for name in _USUAL_SETS)


def _measure_data_set(data: dict[str, Any]) -> float:
    regressors, y, padding = build_regression(data)
    n, p = regressors.shape
    alike = np.full(n, 1e-6 * np.mean(np.abs(y) ** 2))
    white = ErrorsInVariables(np.zeros((n, p, p)), np.zeros((n, p)), alike)
    found = regress(regressors, y, tuple(f"B{k}" for k in range(p)), white)
    errors = np.sqrt(np.diag(found.covariance) * padding)
    digits = (
        count_digits(found.values, data["coefficients"]),
        count_digits(errors, data["std_errors"]),
    )
    return float(10.0 ** -min(digits))


def _measure_short_period() -> float:
    """Largest relative error of frequency and damping of the published derivatives."""
    errors: list[float] = []
    for flight, known in FLIGHTS.items():
        model, table = build_rigid_model(flight)
        poles = np.linalg.eigvals(model.state_space(table).A)
        pole = poles[np.argmax(np.imag(poles))]
        errors.append(abs(abs(pole) / known["natural"] - 1.0))
        errors.append(abs(-pole.real / abs(pole) / known["zeta"] - 1.0))
    return float(max(errors))


def _estimate_gtm(flight: int, noise: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Estimate published derivatives by output error; return errors and standard errors."""
    model, table = build_rigid_model(flight)
    rng = np.random.default_rng(seed)
    u = 0.02 * np.exp(2j * np.pi * rng.uniform(size=(_OMEGA.size, 1)))
    y = (model.response(table, _OMEGA) @ u[:, :, None])[:, :, 0]
    level = noise * np.sqrt(np.mean(np.abs(y) ** 2, axis=0) / 2.0)
    z = y + level * (rng.normal(size=y.shape) + 1j * rng.normal(size=y.shape))
    start = DerivativeTable((), ("de",), 0.75 * table.values)
    experiment = output_error(
        model,
        FrequencyData(_OMEGA, u, ("de",)),
        FrequencyData(_OMEGA, z, model.outputs),
        np.ones(z.shape, dtype=complex),
    )
    found = maximize([experiment], select_parameters(start, None, model.outputs))
    return found.values / table.values.ravel() - 1.0, found.std_errors / np.abs(
        table.values.ravel()
    )


def _measure_recovery() -> float:
    """Largest relative error of output error at a noise of 1e-7 of the outputs."""
    return float(max(np.abs(_estimate_gtm(flight, 1e-7, 0)[0]).max() for flight in FLIGHTS))


def _measure_standard_errors() -> float:
    """Deviation of the rms of error over standard error from one, over repeated estimations."""
    ratios = [np.divide(*_estimate_gtm(41, 0.25, seed)) for seed in range(_REPEATS)]
    return float(abs(np.sqrt(np.mean(np.square(ratios))) - 1.0))


def _measure_flutter() -> float:
    """Largest relative error of the flutter speeds of FLEX-28 over fuel."""
    truth = load_truth()
    errors: list[float] = []
    for fuel, expected in _FLUTTER_FT_S.items():
        aircraft = Aeroelastic(
            truth.condition_at(40.0, fuel), truth.modes_at(fuel, 8), truth.derivatives_at(fuel, 8)
        )
        crossing = track_roots(aircraft, _AIRSPEEDS).flutter
        errors.append(np.inf if crossing is None else crossing.airspeed / _FEET / expected - 1.0)
    return float(np.abs(errors).max())


def _measure_rigid_derivatives() -> float:
    """Largest relative error of the derivatives of HA144A."""
    found = compute_ha144a()
    return float(max(abs(found[name] / printed - 1.0) for name, printed in HA144A.items()))


def _measure_strip_flutter() -> float:
    """Largest relative error of flutter speed and frequency of Goland's wing by strips."""
    flutter = predict_goland_by_strips()
    if flutter is None:
        return np.inf
    speed, omega = GOLAND_EXACT
    return float(max(abs(flutter.airspeed / speed - 1.0), abs(flutter.omega / omega - 1.0)))


def _measure_speed(flutter: PkCrossing | None, expected: float) -> float:
    """Relative error of a flutter speed."""
    return np.inf if flutter is None else float(abs(flutter.airspeed / expected - 1.0))


def _count_unnoticed_changes() -> float:
    """Count changed bytes of a sealed event and of a signed text that are not noticed."""
    event = seal(
        DecisionEvent(
            decision_id=1,
            number=1,
            kind=EventKind.COMMENTED,
            author="verification",
            text="SP + SW1B below 400 Pa",
            revision=1,
            data={"run 1": "a3f1"},
            data_hash=hash_value({"run 1": "a3f1"}),
            software={},
            previous_hash="",
            created_at=datetime(2026, 1, 1, tzinfo=UTC),
        )
    )
    secret = bytes.fromhex(_RFC_SECRET)
    text, public = event.sealed.encode(), derive_public_key(secret)
    signature = sign(secret, text)
    unnoticed = 0
    for place in range(0, len(text), max(1, len(text) // 50)):
        changed = bytearray(text)
        changed[place] ^= 1
        sealed = bytes(changed).decode(errors="replace")
        try:
            unnoticed += is_chain_intact([replace(event, sealed=sealed)])
        except json.JSONDecodeError:  # the hash is compared first: not reached
            continue
        unnoticed += is_valid(public, bytes(changed), signature)
    return float(unnoticed)


def _measure_signature() -> float:
    """Differences from test vector 2 of RFC 8032."""
    secret, message = bytes.fromhex(_RFC_SECRET), bytes([0x72])
    return float(
        (derive_public_key(secret).hex() != _RFC_PUBLIC)
        + (sign(secret, message).hex() != _RFC_SIGNATURE)
        + (not is_valid(bytes.fromhex(_RFC_PUBLIC), message, bytes.fromhex(_RFC_SIGNATURE)))
    )


REQUIREMENTS = (
    Requirement(
        "V1",
        "Least squares give certified coefficients and standard errors (relative error)",
        "NIST Statistical Reference Datasets, linear regression: Norris, Pontius, NoInt, Longley",
        _measure_regression,
        1e-9,
    ),
    Requirement(
        "V2",
        "Published derivatives give the published short period (relative error)",
        "NASA T-2 (GTM), flights 41 and 15: AIAA 2015-2704, Table 3",
        _measure_short_period,
        0.01,
    ),
    Requirement(
        "V3",
        "Output error recovers published derivatives without noise (relative error)",
        "NASA T-2 (GTM): records made from the published derivatives",
        _measure_recovery,
        1e-5,
    ),
    Requirement(
        "V4",
        "Standard errors are those of repeated estimations (rms of error over sigma, less one)",
        f"NASA T-2 (GTM): {_REPEATS} records with noise of a quarter of the outputs",
        _measure_standard_errors,
        0.12,
    ),
    Requirement(
        "V5",
        "Flutter speeds over fuel are those of the design (relative error)",
        "FLEX-28 with eight modes: eigenvalues of an independent program",
        _measure_flutter,
        1e-4,
    ),
    Requirement(
        "V6",
        "Signatures are those of the standard (differences)",
        "RFC 8032, sec. 7.1, test 2",
        _measure_signature,
        0.0,
    ),
    Requirement(
        "V7",
        "A changed byte of a decision or a signed file is noticed (changes not noticed)",
        "Single-bit changes of a sealed and signed event",
        _count_unnoticed_changes,
        0.0,
    ),
    Requirement(
        "V8",
        "The doublet lattice gives the printed rigid derivatives at Mach 0.9 (relative error)",
        "HA144A, forward-swept wing with canard: aeroelastic user's guide of MSC Nastran",
        _measure_rigid_derivatives,
        5e-4,
    ),
    Requirement(
        "V9",
        "The p-k method gives the exact flutter speed and frequency (relative error)",
        "Goland and Luke, J. Appl. Mech. 15 (1948): uniform cantilever wing in strip theory",
        _measure_strip_flutter,
        0.02,
    ),
    Requirement(
        "V10",
        "Lattice and p-k method give the flutter speed of another lattice code (relative error)",
        "Goland's wing at 1.02 kg/m3: SHARPy, doi:10.21105/joss.01885",
        lambda: _measure_speed(predict_goland_by_lattice(), GOLAND_SHARPY),
        0.02,
    ),
    Requirement(
        "V11",
        "Lattice and p-k method give the measured flutter speed at Mach 0.499 (relative error)",
        "AGARD 445.6, weakened model 3, in a wind tunnel: Yates, NASA TM 100492",
        lambda: _measure_speed(predict_agard(), AGARD_MEASURED),
        0.05,
    ),
)


# --- Report of the verification: requirement, reference, limit and result -------------------------


def report_verification(found: Sequence[Measured]) -> Report:
    """Report the tested requirements, with the software and the computer."""
    failed = [one.requirement.id for one in found if not one.is_fulfilled]
    summary = f"{len(found) - len(failed)} of {len(found)} requirements are fulfilled."
    if failed:
        summary += f" Not fulfilled: {', '.join(failed)}. Do not use results of this installation."
    rows = tuple(
        (
            one.requirement.id,
            one.requirement.statement,
            one.requirement.reference,
            f"{one.requirement.limit:.3g}",
            "–" if one.value is None else f"{one.value:.3g}",
            "fulfilled" if one.is_fulfilled else f"not fulfilled {one.failure}".strip(),
        )
        for one in found
    )
    head = ("", "requirement", "reference", "limit", "measured", "result")
    computer = (("System", platform.platform()), ("Python", platform.python_version()))
    return Report(
        title="Verification of the installation",
        subtitle=summary,
        name="flexsid-verification",
        sections=(
            Section("Result", (Words(summary, warns=bool(failed)),)),
            Section("Requirements", (ReportTable(head, rows, numbers_from=3),)),
            Section("Computer", (Facts(computer),)),
        ),
        provenance=tuple(read_versions().items()),
    )

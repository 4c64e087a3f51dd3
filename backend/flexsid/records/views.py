"""Views: the finished numbers behind each figure, in SI and rad.

``workflow`` fills them, ``figures`` draws them; neither knows the other. Arrays
are plain numpy; a number that does not exist is NaN in an array, None in a field.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from flexsid.records.maneuver import Role
from flexsid.records.run import Method, Pole
from flexsid.sysid.estimation.estimate import IterationStep
from flexsid.sysid.excitation.catalogue import Target
from flexsid.sysid.stability.transfer_function import TransferFunctionRoot

# --- Views: the finished numbers behind each figure, in SI and rad --------------------------------


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EnvelopeMark:
    """Where one maneuver was flown."""

    maneuver_id: int
    label: str
    fta: int | None
    fuel_fraction: float
    airspeed_m_s: float
    airspeed_ratio: float | None  # V/V_f
    dynamic_pressure_pa: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Envelope:
    """The conditions of a campaign, one mark per maneuver."""

    marks: tuple[EnvelopeMark, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class DefaultChannels:
    """The channels of a maneuver that views show first.

    ``inputs`` are the surfaces that it moves, with left and right ones that move together as one;
    ``outputs`` are one of each rigid-body quantity of its axis, ``rates`` one rate of each axis,
    and ``combinations`` are those of recorded channels, of its axis first.
    """

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    rates: tuple[str, ...]
    combinations: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ChannelTrace:
    """One channel on its own time axis: ``time_s`` and ``values`` (n_samples,)."""

    name: str
    unit: str
    role: Role
    time_s: np.ndarray
    values: np.ndarray


class LatticeQuantity(StrEnum):
    """Quantity on the boxes of a lattice."""

    LAYOUT = "layout"
    PRESSURE = "pressure"
    MODE = "mode"
    ASPECT_RATIO = "aspect-ratio"
    RESOLUTION = "resolution"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LatticeView:
    """One quantity on the boxes of both halves, and the sensors; x aft, y right, z up [m].

    ``corners`` are (n, 4, 3), displaced where a mode is shown; ``values`` (n,), NaN where there is
    none; of the layout they are indices of ``surfaces``. ``parameter`` is the variable of a
    pressure, or the name of a mode; ``sensors`` are names with x and y.
    """

    quantity: LatticeQuantity
    parameter: str
    corners: np.ndarray
    values: np.ndarray
    surfaces: tuple[str, ...]
    sensors: tuple[tuple[str, float, float], ...]
    note: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SurfaceHistory:
    """A surface as measured, and its command through servo and instrument; None if not recorded."""

    measured: ChannelTrace
    commanded: ChannelTrace | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SurfaceHistories:
    """Surfaces against their commands, left and right ones together; ``points`` per curve."""

    maneuver_id: int
    rows: tuple[tuple[SurfaceHistory, ...], ...]
    points: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ChannelHistories:
    """Channels of a maneuver over one window; downsampled to ``points`` per channel when drawn.

    ``origin`` is the time of second zero, if that is not the zero of the record.
    """

    maneuver_id: int
    traces: tuple[ChannelTrace, ...]
    excitation_s: tuple[float, float] | None
    points: int
    origin: str = ""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Spectra:
    """|X| at the excited harmonics: ``frequency_hz`` (M,), ``magnitude`` (M, n_channels) [unit s].

    ``assigned_inputs`` names, line by line, the input whose excitation has that line, empty
    where none has; ``inputs`` are all inputs of the maneuver, which fixes their colours.
    ``noise`` (M, n_channels) is the level that the scatter about smooth closed-loop
    responses betrays. ``background`` (K, n_channels) at ``background_hz`` (K,) is the
    whole spectrum up to the Nyquist frequency.
    """

    maneuver_id: int
    inputs: tuple[str, ...]
    frequency_hz: np.ndarray
    assigned_inputs: tuple[str, ...]
    names: tuple[str, ...]
    units: tuple[str, ...]
    magnitude: np.ndarray
    noise: np.ndarray | None = None
    background_hz: np.ndarray | None = None
    background: np.ndarray | None = None
    band_hz: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlotMatrix:
    """Channels against each other: ``samples`` (n, c) and ``correlation`` (c, c).

    Complex in the frequency domain. ``inflation`` (c,) is the variance inflation
    factor of each column, ``condition`` the condition number of all together.
    """

    maneuver_id: int
    names: tuple[str, ...]
    units: tuple[str, ...]
    samples: np.ndarray
    correlation: np.ndarray
    inflation: np.ndarray | None = None
    condition: float = float("nan")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ModeMarker:
    """A named frequency: of SW1B in vacuo at the fuel of the maneuver, or of a run's pole."""

    name: str
    frequency_hz: float
    run_id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Blanked:
    """A point of a response that is not shown, and why."""

    frequency_hz: float
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Response:
    """Output over input: ``magnitude`` [unit / unit] and unwrapped ``phase_rad``, both (M,).

    ``relative_std`` (M,) is the standard error of the magnitude over the magnitude,
    which is also that of the phase in radians. ``run_id`` is that of a model, ``maneuver_id``
    None for an average of several maneuvers. ``rigid`` is a model with rigid-body
    sensors (C_e = 0). ``coherence`` (M,) is the share of the output that the inputs
    explain, or that repeats from period to period, where known.
    """

    output: str
    input: str
    output_unit: str
    input_unit: str
    frequency_hz: np.ndarray
    magnitude: np.ndarray
    phase_rad: np.ndarray
    relative_std: np.ndarray | None = None
    run_id: int | None = None
    maneuver_id: int | None = None
    label: str = ""
    is_model: bool = False
    rigid: bool = False
    blanked: tuple[Blanked, ...] = ()
    coherence: np.ndarray | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NoiseShares:
    """Share of the noise variance of one parameter of a run that each frequency has, (M,).

    An estimate rests on the frequencies of large shares.
    """

    run_id: int
    name: str
    frequency_hz: np.ndarray
    shares: np.ndarray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bode:
    """Measured frequency responses with the models laid over them.

    ``agreement`` is, by input, the probability that maneuvers which were averaged
    differ as much by chance. ``noise_shares`` are those of a selected parameter, by run.
    """

    maneuver_id: int
    inputs: tuple[str, ...]  # all of the maneuver: fixes their colours
    measured: tuple[Response, ...]
    models: tuple[Response, ...]
    modes: tuple[ModeMarker, ...]
    agreement: dict[str, float] = field(default_factory=dict[str, float])
    noise_shares: tuple[NoiseShares, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FitTrace:
    """Measured and fitted spectra of one output, as magnitude and phase, all (M,)."""

    output: str
    unit: str
    input: str | None  # FRE: output over this input
    measured_magnitude: np.ndarray
    measured_phase_rad: np.ndarray
    fitted_magnitude: np.ndarray
    fitted_phase_rad: np.ndarray
    r_squared: float | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FitPlot:
    """Fit of one block of a run; ``curve`` names the model's data, by default as the fit.

    ``assigned_inputs`` (M,) names the input that excites each frequency, empty where none does or
    it is not known; ``inputs`` are those of the maneuver, in its order.
    """

    run_id: int
    method: Method
    block: str
    frequency_hz: np.ndarray
    traces: tuple[FitTrace, ...]
    curve: str | None = None
    inputs: tuple[str, ...] = ()
    assigned_inputs: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Residuals:
    """|residual| over the rms residual of its output, ``relative`` (M, n_outputs) [1]."""

    run_id: int
    method: Method
    block: str
    frequency_hz: np.ndarray
    outputs: tuple[str, ...]
    relative: np.ndarray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ParameterCorrelation:
    """Correlation of the estimates, (n_theta, n_theta) [1]."""

    run_id: int
    names: tuple[str, ...]
    correlation: np.ndarray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PoleGroup:
    """Poles of one origin: the estimate of a run, or the structure in vacuo."""

    label: str
    estimated: bool
    poles: tuple[Pole, ...]
    run_id: int | None = None
    method: Method | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PoleMap:
    """Poles of identified models beside reference poles. [rad/s]"""

    groups: tuple[PoleGroup, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Convergence:
    """Cost of a run against its iterations."""

    run_id: int
    iterations: tuple[IterationStep, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CheckedTrace:
    """One output in time, measured and simulated (n_samples,); R2 over the whole record."""

    name: str
    unit: str
    time_s: np.ndarray
    measured: np.ndarray
    simulated: np.ndarray
    r_squared: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TimeCheck:
    """An identified model under the recorded inputs of a maneuver."""

    run_id: int
    method: Method
    maneuver_id: int
    points: int
    traces: tuple[CheckedTrace, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SimulatedOutput:
    """Output of the model of a run, with its fit in percent; None for a constant record."""

    run_id: int
    method: Method
    values: np.ndarray
    fit_percent: float | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ComparedRecord:
    """One output of a maneuver from its start, with the outputs of models."""

    maneuver_id: int
    label: str
    airspeed_m_s: float
    dynamic_pressure_pa: float
    fuel_fraction: float
    time_s: np.ndarray
    measured: np.ndarray
    simulated: tuple[SimulatedOutput, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TimeComparison:
    """One output of several maneuvers and runs, in order of the flight condition."""

    output: str
    unit: str
    points: int
    records: tuple[ComparedRecord, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GroundSpectra:
    """Power of all gauges and accelerometers before and after a flight.

    ``before`` and ``after`` are frequencies [Hz] and power over its mean; ``expected``
    are marks where the fuel burnt should have brought the peaks.
    """

    flight_number: int
    before: tuple[np.ndarray, np.ndarray]
    after: tuple[np.ndarray, np.ndarray]
    expected: tuple[ModeMarker, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DesignedExcitation:
    """One period of a design: ``command`` (n, n_inputs) [units], and its harmonics by input.

    ``frequency_hz`` and ``amplitude`` [unit] are (n_harmonics,) of each input. The unit is rad, of
    throttles their full range.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    time_s: np.ndarray
    command: np.ndarray
    frequency_hz: dict[str, np.ndarray]
    amplitude: dict[str, np.ndarray]


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectedMode:
    """How well a design shows a mode: the best output around its frequency.

    ``n_harmonics`` lie within the mode's half-power band; ``signal_to_noise`` is the amplitude
    ratio of ``output`` there or at the nearest harmonics. Both are None where no harmonic excites
    the mode. [Hz], [1], [1]
    """

    name: str
    frequency_hz: float
    damping: float
    n_harmonics: int
    output: str | None
    signal_to_noise: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetMode(Target):
    """A mode that a design targets, its frequency [Hz] and damping ratio in flight.

    ``group`` is PH, SP, DR, RS, LE or HE of Table 1, or "all" for a structural mode and a design
    that is no row of it; ``number`` is that of the modal table, None for rigid-body modes.
    ``harmonics_per_surface`` is the least number of harmonics of a surface between ``low_hz`` and
    ``high_hz``.
    """

    in_band: bool
    harmonics_per_surface: int


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetModes:
    """The band of a design [Hz] and the modes it targets; ``sentence`` compares them."""

    low_hz: float
    high_hz: float
    modes: tuple[TargetMode, ...]
    sentence: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ExpectedResponse:
    """Predicted response to a design: harmonics, information and signal-to-noise ratios.

    ``information`` is the information per harmonic in parameters, ``signal_to_noise``
    (n_harmonics, n_outputs) is an amplitude ratio, ``correlation`` that of true deflections over
    a period. [1]
    """

    names: tuple[str, ...]
    outputs: tuple[str, ...]
    frequency_hz: dict[str, np.ndarray]
    information: dict[str, np.ndarray]
    signal_to_noise: dict[str, np.ndarray]
    modes: tuple[ExpectedMode, ...]
    surfaces: tuple[str, ...]
    correlation: np.ndarray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoopCurve:
    """Gain of one surface's loop at its harmonics, (M,), with margins.

    ``std`` is of the complex error; ``gain_up`` is a factor, infinite where nothing is crossed.
    """

    surface: str
    frequency_hz: np.ndarray
    gain: np.ndarray
    std: np.ndarray
    gain_up: float
    phase_rad: float
    phase_std_rad: float
    disk: float
    disk_std: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoopPlot:
    """Loops of all excited surfaces of a maneuver, each broken in front of its servo."""

    maneuver_id: int
    curves: tuple[LoopCurve, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlLoopDiagram:
    """Signals of a control loop by their places: what the law reads, computes and drives.

    ``commands`` are those before the mixer, empty without one; ``airspeeds_m_s`` those of the
    schedule; ``excitation`` the inputs of a design, if any.
    """

    reads: tuple[str, ...]
    commands: tuple[str, ...]
    drives: tuple[str, ...]
    airspeeds_m_s: tuple[float, ...]
    delay_s: float
    rate_limit_rad_s: float | None
    excitation: tuple[str, ...]
    is_before_mixer: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReconstructedTrace:
    """One quantity in time, (n_samples,), and its spectrum, (n_omega,), with standard errors.

    ``spectrum_std`` is that of the magnitude. The spectrum has the unit times seconds.
    """

    name: str
    unit: str
    values: np.ndarray
    std: np.ndarray
    spectrum_magnitude: np.ndarray
    spectrum_std: np.ndarray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reconstruction:
    """Motion of a maneuver from all its sensors.

    ``rank`` and ``condition`` (n_omega,) are rank and condition number of the sensor equations at
    each frequency; ``noise_excess`` is the rms difference of each sensor to the others over its
    defined noise, None where unknown.
    """

    maneuver_id: int
    modes: tuple[int, ...]
    mode_names: tuple[str, ...]
    time_s: np.ndarray
    frequency_hz: np.ndarray
    traces: tuple[ReconstructedTrace, ...]
    offered: tuple[str, ...]
    n_motions: int
    rank: np.ndarray
    condition: np.ndarray
    sensors: tuple[str, ...]
    noise_excess: tuple[float | None, ...]
    excluded: dict[str, str]


# --- Transfer functions of one input and output that were fitted to a maneuver --------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferFunction:
    """K (s^m + ...) e^(-tau s) / (s^i (s^n + ...)) with standard errors.

    ``numerator`` and ``denominator`` are coefficients of rising powers of s, the latter without
    the ``integrators``; ``gain`` is the leading one of the numerator, in
    ``gain_unit`` of SI units. ``mismatch`` is the
    standard deviation of the relative error beyond noise, ``mismatch_cost`` that of low-order
    equivalent systems, ``is_close`` whether pilots do not distinguish what of it exceeds noise.
    """

    maneuver_id: int
    input: str
    output: str
    n_zeros: int
    n_poles: int
    integrators: int
    has_delay: bool
    band_hz: tuple[float, float]
    n_frequencies: int
    gain: float
    gain_std: float
    gain_unit: str
    delay_s: float
    delay_std_s: float
    numerator: tuple[float, ...]
    denominator: tuple[float, ...]
    zeros: tuple[TransferFunctionRoot, ...]
    poles: tuple[TransferFunctionRoot, ...]
    mismatch: float
    mismatch_cost: float
    cost_beyond_noise: float
    is_close: bool
    sentence: str
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputOnlyMode:
    """A mode identified from outputs, with standard errors; its shape has a largest part of one.

    ``number``, ``name`` and ``mac`` are those of the most similar mode of the modal table, None
    and empty where none is similar.
    """

    frequency_hz: float
    frequency_std_hz: float
    damping: float
    damping_std: float
    shape_real: tuple[float, ...]
    shape_imag: tuple[float, ...]
    number: int | None
    name: str
    mac: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputOnlyResult:
    """Modes of a part of a record from its outputs alone.

    ``excluded`` has the reason by output that is left out, ``tones_hz`` the steady tones left out.
    ``measured`` and ``fitted`` are means over the outputs of the spectral density, relative to the
    variance of each [1/Hz].
    """

    maneuver_id: int
    band_hz: tuple[float, float]
    start_s: float
    duration_s: float
    outputs: tuple[str, ...]
    excluded: dict[str, str]
    modes: tuple[OutputOnlyMode, ...]
    tones_hz: tuple[float, ...]
    frequency_hz: tuple[float, ...]
    measured: tuple[float, ...]
    fitted: tuple[float, ...]
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferFunctionResult:
    """A transfer function with the measured response and its own."""

    function: TransferFunction
    measured: Response
    modelled: Response

"""Glossary: symbols, units and labels of everything that is displayed.

Axis titles, tables, the API and the in-app glossary use it, so that a quantity has
one name, one unit and one definition. Values are SI and radians (``unit``) and are
displayed in ``display_unit`` after multiplication by ``display_factor``, which follow
``flexsid.display_units``. Names of channels and derivatives follow flight-test practice
and are parsed by pattern; see :func:`describe`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import lru_cache
from html import escape
from math import tau

from flexsid.display_units import display_unit


@dataclass(frozen=True, slots=True)
class Symbol:
    """One quantity: symbol, unit and meaning."""

    symbol: str
    """Name in code, files and addresses."""
    unit: str
    """SI unit of stored and computed values; empty where nothing is known."""
    label: str
    """Plain text, for tables and narrow places."""
    html: str
    """Label with subscripts, as figures draw it."""
    meaning: str
    """One sentence or less."""
    is_frequency: bool = False
    """Whether it is an angular frequency, which is displayed as a frequency."""

    @property
    def display_unit(self) -> str:
        """Unit of displayed values."""
        return display_unit("Hz" if self.is_frequency else self.unit)[0]

    @property
    def display_factor(self) -> float:
        """Displayed value = factor * SI value."""
        if self.is_frequency:
            return display_unit("Hz")[1] / tau
        return display_unit(self.unit)[1]

    @property
    def axis_title(self) -> str:
        """Label and displayed unit, as in the title of an axis."""
        if self.display_unit in ("", "1"):
            return self.html
        return f"{self.html} [{self.display_unit}]"


def _symbol(symbol: str, unit: str, label: str, html: str, meaning: str) -> Symbol:
    return Symbol(symbol, unit, label, html, meaning)


def _circular(symbol: str, label: str, html: str, meaning: str) -> Symbol:
    """Return an angular frequency, displayed in Hz or rad/s."""
    return Symbol(symbol, "rad/s", label, html, meaning, is_frequency=True)


def _term(name: str, meaning: str) -> Symbol:
    """Return the entry of an abbreviation or of a choice, which has no unit."""
    return _symbol(name, "1", name, name, meaning)


_ETADOT = "\N{GREEK SMALL LETTER ETA}\N{COMBINING DOT ABOVE}"
_ETADDOT = "\N{GREEK SMALL LETTER ETA}\N{COMBINING DIAERESIS}"
_PDOT = "p\N{COMBINING DOT ABOVE}"
_QDOT = "q\N{COMBINING DOT ABOVE}"
_VDOT = "V\N{COMBINING DOT ABOVE}"
_RDOT = "r\N{COMBINING DOT ABOVE}"

GLOSSARY: tuple[Symbol, ...] = (
    # Motion of the aircraft
    _symbol("alpha", "rad", "α", "α", "angle of attack"),
    _symbol("beta", "rad", "β", "β", "angle of sideslip"),
    _symbol("p", "rad/s", "p", "p", "roll rate, right wing down"),
    _symbol("q", "rad/s", "q", "q", "pitch rate, nose up"),
    _symbol("r", "rad/s", "r", "r", "yaw rate, nose right"),
    _symbol("phi", "rad", "ϕ", "ϕ", "bank angle"),
    _symbol("theta", "rad", "θ", "θ", "pitch angle"),
    _symbol("psi", "rad", "ψ", "ψ", "heading angle"),
    _symbol("gamma", "rad", "γ", "γ", "flight path angle"),
    _symbol("eta", "1", "η", "η", "generalised displacement of a structural mode"),
    _symbol("etadot", "1/s", _ETADOT, _ETADOT, "generalised velocity of a structural mode"),
    _symbol("etaddot", "1/s2", _ETADDOT, _ETADDOT, "generalised acceleration of a mode"),
    _symbol("V", "m/s", "V", "V", "deviation of true airspeed from trim"),
    _symbol("Vdot", "m/s2", _VDOT, _VDOT, "rate of true airspeed"),
    _symbol("qdot", "rad/s2", _QDOT, _QDOT, "pitch acceleration, nose up"),
    _symbol(
        "normal_acceleration",
        "m/s2",
        "az c.g.",
        "a<sub>z</sub><sup>cg</sup>",
        "specific force down at the centre of gravity",
    ),
    _symbol("pdot", "rad/s2", _PDOT, _PDOT, "roll acceleration, right wing down"),
    _symbol("rdot", "rad/s2", _RDOT, _RDOT, "yaw acceleration, nose right"),
    _symbol(
        "lateral_acceleration",
        "m/s2",
        "ay c.g.",
        "a<sub>y</sub><sup>cg</sup>",
        "specific force to the right at the centre of gravity",
    ),
    _symbol("delta", "rad", "δ", "δ", "control surface deflection, trailing edge down"),
    # Flight condition
    _symbol("airspeed", "m/s", "V", "V", "true airspeed"),
    _symbol("dynamic_pressure", "Pa", "q̄", "q̄", "dynamic pressure"),
    _symbol("density", "kg/m3", "ρ", "ρ", "air density"),
    _symbol("flutter_speed", "m/s", "V_f", "V<sub>f</sub>", "predicted open-loop flutter speed"),
    _symbol("airspeed_ratio", "1", "V/V_f", "V/V<sub>f</sub>", "true airspeed over flutter speed"),
    _symbol("fuel_fraction", "1", "w/w_ff", "w/w<sub>ff</sub>", "fuel over full-fuel weight"),
    _symbol("mass", "kg", "m", "m", "mass of the aircraft"),
    _symbol("pitch_inertia", "kg*m2", "I_yy", "I<sub>yy</sub>", "moment of inertia in pitch"),
    _symbol("roll_inertia", "kg*m2", "I_xx", "I<sub>xx</sub>", "moment of inertia in roll"),
    _symbol("yaw_inertia", "kg*m2", "I_zz", "I<sub>zz</sub>", "moment of inertia in yaw"),
    _symbol(
        "product_of_inertia", "kg*m2", "I_xz", "I<sub>xz</sub>", "product of inertia, ∫ x z dm"
    ),
    _symbol("thrust", "N", "X_T", "X<sub>T</sub>", "thrust along the body x axis"),
    # Geometry
    _symbol("area", "m2", "S", "S", "wing reference area"),
    _symbol("chord", "m", "c̄", "c̄", "mean aerodynamic chord"),
    _symbol("span", "m", "b", "b", "wing span"),
    # Structure
    _circular("natural_frequency", "ω_i", "ω<sub>i</sub>", "in-vacuo frequency of a mode"),
    _symbol("damping_ratio", "1", "ζ_i", "ζ<sub>i</sub>", "structural damping ratio of a mode"),
    _symbol("modal_mass", "kg*m2", "m_i", "m<sub>i</sub>", "generalised mass of a mode"),
    # Coefficients
    _symbol("CZ", "1", "C_Z", "C<sub>Z</sub>", "force coefficient along body z, downwards"),
    _symbol(
        "CX", "1", "C_X", "C<sub>X</sub>", "force coefficient forwards, along the velocity (-C_D)"
    ),
    _symbol("CY", "1", "C_Y", "C<sub>Y</sub>", "force coefficient along body y, right"),
    _symbol("CL", "1", "C_L", "C<sub>L</sub>", "lift coefficient"),
    _symbol("CD", "1", "C_D", "C<sub>D</sub>", "drag coefficient"),
    _symbol("Cl", "1", "C_l", "C<sub>l</sub>", "rolling moment coefficient"),
    _symbol("Cm", "1", "C_m", "C<sub>m</sub>", "pitching moment coefficient, nose up"),
    _symbol("Cn", "1", "C_n", "C<sub>n</sub>", "yawing moment coefficient"),
    _symbol("CQ", "1", "C_Q", "C<sub>Q</sub>", "generalised force coefficient of a mode"),
    # Signals and spectra
    _symbol("time", "s", "t", "t", "time since the start of the record"),
    _circular("omega", "f", "f", "frequency"),
    _symbol("magnitude", "1", "|H|", "|H|", "magnitude of a frequency response"),
    _symbol("phase", "rad", "∠H", "∠H", "phase of a frequency response"),
    _symbol("correlation", "1", "r", "r", "pairwise correlation coefficient"),
    _symbol(
        "max_input_correlation", "1", "max |r|", "max |r|", "largest correlation of any two inputs"
    ),
    # Estimation
    _symbol("cost", "1", "J", "J", "negative log-likelihood minimised by a fit"),
    _symbol("r_squared", "1", "R²", "R<sup>2</sup>", "share of an output explained by the model"),
    _symbol("std_error", "1", "σ", "σ", "standard error of an estimate"),
    _symbol("residual", "1", "ν", "ν", "measured minus modelled output"),
    _symbol(
        "adequacy",
        "1",
        "Model adequacy",
        "Model adequacy",
        "tests for remaining model error: consistent, suspect or not tested",
    ),
    _symbol("delay", "s", "τ", "τ", "time delay of a channel"),
)
"""Quantities with a fixed name; families of names are parsed by :func:`describe`."""

TERMS: tuple[Symbol, ...] = (
    _term("FTA", "flight test aid: number of the programmed excitation"),
    _term("OE", "output error: fits measured outputs by outputs simulated from measured inputs"),
    _term("FRE", "frequency-response error: fits frequency responses, one for each input"),
    _term("EE", "equation error: linear regression of one coefficient at a time"),
    _term("FEM", "finite element model, the source of computed modes"),
    _term("GVT", "ground vibration test, the source of measured modes and damping"),
    _term("mini-GVT", "vibration on the runway before and after a flight, compared for damage"),
    _term("MAC", "modal assurance criterion: squared correlation of two mode shapes, 0 to 1"),
    _term(
        "Phase collinearity",
        "modal phase collinearity (MPC): 1 where all points move in phase or against it",
    ),
    _term("SP", "short-period mode: angle of attack and pitch rate"),
    _term("SW1B", "first symmetric wing bending mode"),
    _term("SW1T", "first symmetric wing torsion mode"),
    _term("Equivalent delay", "of a transfer function of low order: for dynamics that it omits"),
    _term("Mismatch cost", "20 times the mean of dB² + 0.02 deg² over the logarithm of frequency"),
    _term("RPF", "relative peak factor: peak-to-peak over 2√2 rms; 1 for a single sine"),
    _term("Theil", "inequality coefficient of measured and predicted output; 0 is perfect"),
    _term("Insensitivity", "σ if all other parameters were known exactly"),
    _term("Repeatability", "σ of the scatter of repeated flights: what noise alone causes"),
    _term("Cramér-Rao", "Cramér-Rao bound: σ if the noise were as the fit estimated it"),
    _term("Start", "initial values of the iteration"),
    _term("Most likely candidate", "of equation error and prediction, that with higher likelihood"),
    _term("Equation error estimate", "initial values from equation error on the same data"),
    _term("Prediction", "initial values of all derivatives as predicted"),
    _term(
        "Residualized prediction",
        "prediction in which omitted modes respond statically",
    ),
    _term("Retained modes", "modes outside the model structure, with a prior at the prediction"),
    _term("Input corr.", "largest pairwise correlation of the inputs as measured"),
    _term("Worst R²", "R² of the output that is fitted worst"),
    _term("Outcome", "how the iteration ended: converged, or the reason why not"),
    _term("Iterations", "number of iterations until the end"),
    _term(
        "Noise",
        "share of σ² due to noise; the rest is due to out-of-band modes and the modal table",
    ),
    _term("Runs differ", "largest difference between two runs, in their joint σ"),
    _term("Change", "estimate minus initial value, over σ"),
)
"""Abbreviations, columns and choices of the page; not searched by :func:`describe`, since a
channel may have the same name."""

_BY_NAME = {entry.symbol: entry for entry in GLOSSARY}
_TERM_BY_NAME = {entry.symbol: entry for entry in TERMS}

_PLACES = {
    "egi": "embedded GPS/INS",
    "cf": "center body, forward",
    "cfy": "center body, forward",
    "ca": "center body, aft",
    "mf": "wing midspan, forward",
    "ma": "wing midspan, aft",
    "of": "outboard wing, forward",
    "oa": "outboard wing, aft",
    "wl": "winglet",
}
_SIDES = {"l": "left", "r": "right", "s": "symmetric part", "a": "antisymmetric part"}
_AXES = {"x": "forward", "y": "right", "z": "down"}
_COEFFICIENTS = {
    "X": "axial force",
    "Y": "side force",
    "Z": "vertical force",
    "L": "lift",
    "D": "drag",
    "l": "rolling moment",
    "m": "pitching moment",
    "n": "yawing moment",
}
MOTIONS = {
    "alpha": "angle of attack",
    "alphadot": "rate of angle of attack",
    "beta": "sideslip",
    "p": "roll rate",
    "q": "pitch rate",
    "r": "yaw rate",
    "V": "true airspeed over that of trim",
}
"""Rigid-body motions by which derivatives are taken."""

_GAUGE = re.compile(r"(bend|ros)(\d)([lrsa])(?:_(m45|0|p45))?")
_SURFACE = re.compile(r"(bf|wf)(\d?)([lrsa]?)")
_MODAL = re.compile(r"eta(d?dot)?(\d+)")
_MODAL_WORDS = {None: "displacement", "dot": "velocity", "ddot": "acceleration"}
_ENGINES = ("thrust", "throttle")  # inputs that are no surfaces
_ANGLES = {"m45": "−45°", "0": "0°", "p45": "+45°"}


@lru_cache(maxsize=4096)
def describe(name: str, unit: str = "") -> Symbol:
    """Return symbol, units and label of a quantity, channel or derivative.

    Parameters
    ----------
    name
        A glossary name (``dynamic_pressure``), a channel (``az_ofs``,
        ``s_bend1r``, ``wf4s``, ``bfs_command``), a modal coordinate (``eta9``),
        a derivative (``CZ_alpha``, ``CQ7_etadot9``) or a delay (``tau_az_ofs``).
    unit
        SI unit of the values; used for names that are not in the glossary.

    Returns
    -------
    Symbol
        Never fails: an unknown name is its own label.
    """
    found = _BY_NAME.get(name) or _parse(name)
    if found is None:
        return _symbol(name, unit, name, escape(name), "")
    if unit and unit != found.unit:
        return replace(found, unit=unit, is_frequency=False)
    return found


def explain(name: str) -> Symbol:
    """Return the term of the page with this name, else what :func:`describe` returns."""
    return _TERM_BY_NAME.get(name) or describe(name)


def _parse(name: str) -> Symbol | None:
    for pattern, explain in _FAMILIES:
        match = pattern.fullmatch(name)
        if match is not None:
            return _symbol(name, *explain(match))
    return None


_Explanation = tuple[str, str, str, str]
"""Unit, label, label of figures, and meaning."""


def _explain_modal(match: re.Match[str]) -> _Explanation:
    derivative, mode = match.groups()
    kind = _BY_NAME[f"eta{derivative or ''}"]
    meaning = f"generalised {_MODAL_WORDS[derivative]} of mode {mode}"
    return kind.unit, f"{kind.label}{mode}", f"{kind.html}<sub>{mode}</sub>", meaning


def _explain_force(match: re.Match[str]) -> _Explanation:
    mode = match[1]
    meaning = f"generalised force coefficient of mode {mode}"
    return "1", f"C_Q{mode}", f"C<sub>Q{mode}</sub>", meaning


def _explain_derivative(match: re.Match[str]) -> _Explanation:
    coefficient, variable = match.groups()
    text, unit, meaning = _explain_variable(variable)
    # An index needs a mark between it and what follows; single letters do not.
    mark = "," if len(coefficient) > 1 or len(text) > 1 else ""
    force = _COEFFICIENTS.get(coefficient) or f"generalised force of mode {coefficient[1:]}"
    html = f"C<sub>{escape(coefficient)}{mark}{escape(text)}</sub>"
    return unit, f"C_{coefficient}{mark}{text}", html, f"{force} with {meaning}, nondimensional"


def _explain_variable(variable: str) -> tuple[str, str, str]:
    """Text, unit of the derivative, and words for what a derivative is taken by."""
    modal = _MODAL.fullmatch(variable)
    if modal is not None:
        text = _ETADOT if modal[1] else "η"
        what = "velocity" if modal[1] else "displacement"
        return f"{text}{modal[2]}", "1", f"{what} of mode {modal[2]}"
    if variable in MOTIONS:
        glyph = {"alpha": "α", "alphadot": "α̇", "beta": "β"}.get(variable, variable)
        return glyph, "1" if variable == "V" else "1/rad", MOTIONS[variable]
    if variable.startswith(_ENGINES):
        return variable, "", f"{variable}, per unit of its channel"
    return f"δ{variable}", "1/rad", f"deflection of {_surface_words(variable)}"


def _explain_command(match: re.Match[str]) -> _Explanation:
    surface = match[1]
    meaning = f"excitation added to the command of {_surface_words(surface)}"
    return "rad", f"{surface} command", f"μ<sub>{escape(surface)}</sub>", meaning


def _explain_delay(match: re.Match[str]) -> _Explanation:
    channel = match[1]
    return "s", f"τ_{channel}", f"τ<sub>{escape(channel)}</sub>", f"time delay of {channel}"


def _explain_acceleration(match: re.Match[str]) -> _Explanation:
    axis, place = match.groups()
    html = f"a<sub>{axis}</sub><sup>{escape(place)}</sup>"
    return "m/s2", f"a{axis} {place}", html, f"specific force {_AXES[axis]}, {_place_words(place)}"


def _explain_strain(match: re.Match[str]) -> _Explanation:
    gauge = match[1]
    return "strain", f"ε {gauge}", f"ε<sup>{escape(gauge)}</sup>", _gauge_words(gauge)


def _explain_surface(match: re.Match[str]) -> _Explanation:
    surface = match[0]
    meaning = f"deflection of {_surface_words(surface)}"
    return "rad", f"δ {surface}", f"δ<sub>{surface}</sub>", meaning


_FAMILIES = (
    (_MODAL, _explain_modal),
    (re.compile(r"CQ(\d+)"), _explain_force),
    (re.compile(r"C(Q\d+|[XYZLDlmn])_([A-Za-z]\w*)"), _explain_derivative),
    (re.compile(r"(.*)_command"), _explain_command),
    (re.compile(r"tau_(.*)"), _explain_delay),
    (re.compile(r"a([xyz])_(\w+)"), _explain_acceleration),
    (re.compile(r"s_(\w+)"), _explain_strain),
    (_SURFACE, _explain_surface),
)


def _surface_words(surface: str) -> str:
    match = _SURFACE.fullmatch(surface)
    if match is None:
        return surface
    flap = "body flaps" if match[1] == "bf" else "wing flaps"
    words = f"{flap} {match[2]}".strip()
    return f"{words}, {_SIDES[match[3]]}" if match[3] else words


def _place_words(place: str) -> str:
    if place in _PLACES:
        return _PLACES[place]
    words, side = _PLACES.get(place[:-1]), _SIDES.get(place[-1])
    return f"{words}, {side}" if words and side else place


def _gauge_words(gauge: str) -> str:
    match = _GAUGE.fullmatch(gauge)
    if match is None:
        return f"strain at gauge {gauge}"
    kind = "bending bridge" if match[1] == "bend" else "rosette"
    leg = f" {_ANGLES[match[4]]}" if match[4] else ""
    return f"strain, {kind} {match[2]}{leg}, {_SIDES[match[3]]}"

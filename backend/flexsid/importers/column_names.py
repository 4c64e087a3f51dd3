"""Usual names of recorded columns, and the quantities that they denote."""

from __future__ import annotations

import re
from dataclasses import dataclass

from flexsid import units
from flexsid.importers.source import COUNTS
from flexsid.records.maneuver import Role


@dataclass(frozen=True, slots=True, kw_only=True)
class Meaning:
    """Quantity of a recorded column; ``sure`` if its unit is given, not guessed.

    An unknown unit of the recorder is retained as written.
    """

    name: str
    unit: str
    role: Role
    sure: bool = True
    known: bool = True
    """Whether the name is a usual one; else the role is guessed as well."""
    surface: str = ""
    """Field of the first column that moves as this one: its command or its other side."""


_IN_NAME = re.compile(r"^(?P<name>.*?)\s*[\[(](?P<unit>[^\])]*)[\])]$")

_COMMANDED = re.compile(
    r"^(?P<name>.+?)_?(?:command|cmd)(?P<rest>_\w+|\s*[\[(].*|)$", re.IGNORECASE
)

_SUFFIXES = {
    "deg": "deg", "rad": "rad", "dps": "deg/s", "degs": "deg/s", "rps": "rad/s", "g": "g",
    "kt": "kt", "kts": "kt", "fps": "ft/s", "mps": "m/s", "ft": "ft", "m": "m", "psf": "psf",
    "pa": "Pa", "ms": "ms", "s": "s", "lb": "lb", "kg": "kg", "ustrain": "ustrain", "v": "V",
    "pct": "%", "percent": "%", "degc": "degC", "degf": "degF", "hpa": "hPa", "kpa": "kPa",
    "psi": "psi", "inhg": "inHg", "kmh": "km/h", "mps2": "m/s2", "fps2": "ft/s2", "ms2": "m/s2",
    "degps": "deg/s", "radps": "rad/s", "degps2": "deg/s2", "radps2": "rad/s2", "ftps": "ft/s",
    "ftps2": "ft/s2", "mrad": "mrad", "slug": "slug", "lbf": "lbf", "hz": "Hz",
    "microstrain": "ustrain", "sec": "s", "feet": "ft", "knots": "kt",
}  # fmt: skip

_ANGLE, _RATE, _ACCELERATION, _SPEED = "deg", "deg/s", "g", "kt"

_DELTA = "(?:del(?:ta)?_?)?"  # before a surface: elsewhere it may begin another word, as in delay
_SURFACES = {
    "elevator": "el|elev|elevator|stab|stabilator",
    "aileron": "ail|aileron",
    "rudder": "rud|rdr|rudder",
    "elevon": "elevon",
    "flaperon": "flaperon",
}

# Pattern of the whole name in lower case, name in flexsid, usual unit, role.
_KNOWN: tuple[tuple[str, str, str, Role], ...] = (
    ("alpha|aoa|alfa", "alpha", _ANGLE, Role.OUTPUT),
    ("beta|aos|sideslip", "beta", _ANGLE, Role.OUTPUT),
    ("p|roll_?rate|gyro?_?x|wx", "p", _RATE, Role.OUTPUT),
    ("q|pitch_?rate|gyro?_?y|wy", "q", _RATE, Role.OUTPUT),
    ("r|yaw_?rate|gyro?_?z|wz", "r", _RATE, Role.OUTPUT),
    ("phi|roll|bank", "phi", _ANGLE, Role.OUTPUT),
    ("the|theta|pitch", "theta", _ANGLE, Role.OUTPUT),
    ("psi|yaw|heading", "psi", _ANGLE, Role.OUTPUT),
    (r"(?:acc|accel|a|n)_?(?P<tail>[xyz](?:_\w+)?)", "a{tail}", _ACCELERATION, Role.OUTPUT),
    (r"accel_(?P<tail>\w+)", "az_{tail}", _ACCELERATION, Role.OUTPUT),
    (r"(?:s|strain|sg)_(?P<tail>\w+)", "s_{tail}", "ustrain", Role.OUTPUT),
    ("(?:d|del|delta)_?e", "elevator", _ANGLE, Role.INPUT),
    ("(?:d|del|delta)_?a", "aileron", _ANGLE, Role.INPUT),
    ("(?:d|del|delta)_?r", "rudder", _ANGLE, Role.INPUT),
    *(
        (rf"{_DELTA}(?:{names}){tail}", surface + ending, _ANGLE, Role.INPUT)
        for surface, names in _SURFACES.items()
        for tail, ending in (("", ""), ("_?(?P<tail>l|r|lh|rh|left|right)", "_{tail}"))
    ),
    (rf"{_DELTA}(?P<tail>(?:bf|wf\d)[slra]?)", "{tail}", _ANGLE, Role.INPUT),
    (r"del_(?P<tail>\w+)", "{tail}", _ANGLE, Role.INPUT),
    ("v|vt|tas|vtas|ktas|airspeed|true_?airspeed", "airspeed", _SPEED, Role.CONDITION),
    ("ias|cas|kias|kcas", "indicated_airspeed", _SPEED, Role.CONDITION),
    ("h|alt|altitude|hp|pressure_?alt(?:itude)?", "altitude", "ft", Role.CONDITION),
    ("mach|ma", "mach", "1", Role.CONDITION),
    ("qbar|q_?bar|dynamic_?pressure", "dynamic_pressure", "psf", Role.CONDITION),
    ("rho|density", "density", "slug/ft3", Role.CONDITION),
    ("fuel|fuel_?fraction", "fuel_fraction", "1", Role.CONDITION),
    ("fuel|fuel_?weight|fuel_?mass", "fuel_mass", "lb", Role.CONDITION),
    ("throttle|thtl|power|pla", "throttle", "%", Role.CONDITION),
)

_OF_AUTOPILOTS: dict[str, tuple[str, str, Role]] = {
    **{f"vehicle_angular_velocity.xyz.{k}": ("pqr"[k], "rad/s", Role.OUTPUT) for k in range(3)},
    **{f"vehicle_acceleration.xyz.{k}": (f"a{'xyz'[k]}", "m/s2", Role.OUTPUT) for k in range(3)},
    "airspeed_validated.true_airspeed_m_s": ("airspeed", "m/s", Role.CONDITION),
    "airspeed_validated.indicated_airspeed_m_s": ("indicated_airspeed", "m/s", Role.CONDITION),
    "vehicle_air_data.rho": ("density", "kg/m3", Role.CONDITION),
    "vehicle_air_data.baro_alt_meter": ("altitude", "m", Role.CONDITION),
    "RATE.R": ("p", "deg/s", Role.OUTPUT),
    "RATE.P": ("q", "deg/s", Role.OUTPUT),
    "RATE.Y": ("r", "deg/s", Role.OUTPUT),
    "ARSP.Airspeed": ("indicated_airspeed", "m/s", Role.CONDITION),
}
"""Fields of logs of PX4 and ArduPilot whose last part does not name the quantity.

Source: messages of PX4 (https://docs.px4.io/main/en/msg_docs) and log messages of ArduPlane.
"""

_NOT_MEASURED = re.compile(
    r"(?:^|[._])(?:setpoint|sp|desired|innov\w*|ratios?|device_id|id|count|manual_control\w*"
    r"|var(?:iances?)?|cov(?:ariances?)?|ref(?:erence)?|target|tar|demand(?:ed)?|err(?:or)?|integ"
    r"|sticks?|pedals?|yoke|joystick)(?=[._ ]|$)|setpoint|innovation|test_ratio",
    re.IGNORECASE,
)
_COMPUTED = re.compile(
    r"\.(?:Des|Nav|Err)[A-Z]\w*$|\.\w*(?:Des|Out|Err|dem)$|^(?:PID\w|[NX]KF[345]|AETR)\.|^ARSP\.H$"
)
"""Names of what an autopilot computes or receives, apart from what its sensors measure.

``_COMPUTED`` are log messages of ArduPlane: demands, terms of controllers, innovations, outputs
before the mixer, health.
"""

_SERVO = re.compile(
    r"pwm|(?:^|[._])(?:servo|rcou|rcin|input_rc|chan|actuator_outputs)(?=[._\d]|$)", re.IGNORECASE
)

_SPELLED = re.compile(r"_(rad|deg|m|ft)_(s2?)$", re.IGNORECASE)
"""Units of which the names of logs have the letters alone: q_rad_s."""

_TIME = re.compile(
    r"t|time|zeit|clock|timestamps?|(?:time|t|epoch)_(?:s|ms|us|ns|sec|utc|gps)|sec(?:onds)?|ms|epoch"
    r"|(?:utc|irig)(?:_?time)?|gps_?time|(?:gps_?)?(?:tow|sow|time_?of_?week)(?:_m?s)?"
)
_PERHAPS_TIME = re.compile(r"(?:time|t)(?:_\w+|\d+)")

_TIME_UNITS = {"ms": "ms", "us": "us", "ns": "ns", "min": "min", "s": "s", "sec": "s"}

_FDATA: dict[Role, dict[int, tuple[str, str]]] = {
    Role.INPUT: {14: ("elevator", "deg"), 15: ("aileron", "deg"), 16: ("rudder", "deg")},
    Role.OUTPUT: {
        3: ("beta", "deg"), 4: ("alpha", "deg"),
        5: ("p", "deg/s"), 6: ("q", "deg/s"), 7: ("r", "deg/s"),
        8: ("phi", "deg"), 9: ("theta", "deg"), 10: ("psi", "deg"),
        11: ("ax", "g"), 12: ("ay", "g"), 13: ("az", "g"),
        42: ("pdot", "deg/s2"), 43: ("qdot", "deg/s2"), 44: ("rdot", "deg/s2"),
    },
    Role.CONDITION: {
        2: ("airspeed", "ft/s"), 27: ("dynamic_pressure", "psf"), 28: ("mach", "1"),
        29: ("density", "slug/ft3"), 30: ("altitude", "ft"), 48: ("mass", "slug"),
        49: ("roll_inertia", "slug*ft2"), 50: ("pitch_inertia", "slug*ft2"),
        51: ("yaw_inertia", "slug*ft2"), 52: ("Ixz", "slug*ft2"),
    },
}  # fmt: skip
"""Columns of the matrix ``fdata`` of SIDPAC users, whose column 1 is time.

Source: SIDPAC, scripts compfc, compmc and f16_fltdatsel (E. A. Morelli).
"""

FDATA_COLUMNS = 90

BODY_VELOCITIES = ("u", "v", "w")


def is_unit(text: str) -> bool:
    """Return whether a text is a unit, also as recorders spell it (dps, knots)."""
    return bool(_unit(text))


def is_time_name(path: str) -> bool:
    """Return whether a name is a usual name of time."""
    return _TIME.fullmatch(_bare(path)[0].lower()) is not None


def may_be_time_name(path: str) -> bool:
    """Return whether a name may denote time, among other quantities."""
    return is_time_name(path) or _PERHAPS_TIME.fullmatch(_bare(path)[0].lower()) is not None


def is_measured(path: str) -> bool:
    """Return whether a name is not that of a set-point, an innovation, an identity or the like."""
    return _NOT_MEASURED.search(path) is None and _COMPUTED.search(path) is None


def is_servo(path: str) -> bool:
    """Return whether a name is that of an output to a servo."""
    return _SERVO.search(path) is not None


def find_time_unit(path: str, file_unit: str) -> str | None:
    """Return the unit of a time column from its file or its name; None if neither states it."""
    name, unit = _bare(path)
    for stated in (file_unit, unit, name.rpartition("_")[2] if "_" in name else "", name):
        found = _TIME_UNITS.get(stated.strip("[]() ").lower())
        if found is not None:
            return found
    return None


def find_commanded_name(path: str) -> str | None:
    """Return the name of the quantity that a field commands; None if it is not a command."""
    found = _COMMANDED.match(path.strip())
    return None if found is None else found["name"] + found["rest"]


def recognise_column(path: str, file_unit: str) -> Meaning:
    """Guess the quantity of a field from its name and the unit that its file gives.

    A field with an unknown name becomes an output under its own name.
    """
    if path in _OF_AUTOPILOTS:
        name, usual, role = _OF_AUTOPILOTS[path]
        return Meaning(name=name, unit=usual, role=role)
    bare, named_unit = _bare(path)
    if not is_measured(path):
        found = _IN_NAME.match(path.strip())  # the last part alone is that of the measurement
        bare = (found["name"] if found else path.strip()).replace(".", "_")
        unit = _unit(file_unit) or _unit(named_unit)
        return Meaning(name=bare, unit=unit or "1", role=Role.OUTPUT, sure=bool(unit), known=False)
    if file_unit == COUNTS:
        return Meaning(name=bare, unit="1", role=Role.OUTPUT, sure=False, known=False)
    unit = _unit(file_unit) or _unit(named_unit)
    unknown = "" if unit else named_unit.strip()
    own, bare = bare, _SPELLED.sub(lambda found: f"_{found[1]}p{found[2]}", bare)
    # Without its unit first: the last part of NZ_G is a unit, that of az_ofs a place.
    for candidate in dict.fromkeys((bare.rpartition("_")[0], bare)):
        suffix = "" if candidate == bare else bare.rpartition("_")[2].lower()
        if not candidate or (suffix and suffix not in _SUFFIXES):
            continue
        for pattern, name, usual, role in _KNOWN:
            found = re.fullmatch(pattern, candidate, re.IGNORECASE)
            if found is None:
                continue
            stated = unit or _SUFFIXES.get(suffix, "")
            if stated and units.dimension(stated) != units.dimension(usual):
                continue
            tail = found.groupdict().get("tail") or ""
            tail = tail.lower() if tail.isupper() else tail
            return Meaning(
                name=name.replace("{tail}", tail),
                unit=stated or unknown or usual,
                role=role,
                sure=bool(stated) or name == "mach",
            )
    suffix = bare.rpartition("_")[2].lower()
    unit = unit or (_SUFFIXES.get(suffix, "") if len(suffix) > 1 else "")
    return Meaning(name=own, unit=unit or "1", role=Role.OUTPUT, sure=bool(unit), known=False)


def find_body_velocity(path: str, file_unit: str) -> Meaning | None:
    """Return the meaning of a column u, v or w of a file that has all three; else None."""
    bare, named_unit = _bare(path)
    name = _SPELLED.sub("", bare).lower()
    if name not in BODY_VELOCITIES:
        return None
    spelled = _SPELLED.search(bare)
    letters = "" if spelled is None else f"{spelled[1]}p{spelled[2]}".lower()
    unit = _unit(file_unit) or _unit(named_unit) or _SUFFIXES.get(letters, "")
    return Meaning(name=name, unit=unit or "m/s", role=Role.OUTPUT, sure=bool(unit))


def find_fdata_column(column: int) -> Meaning | None:
    """Return the quantity of a column of SIDPAC's ``fdata``; None for columns not in ``_FDATA``."""
    for role, columns in _FDATA.items():
        if column in columns:
            name, unit = columns[column]
            return Meaning(name=name, unit=unit, role=role, sure=False)
    return None


def _bare(path: str) -> tuple[str, str]:
    """Return the last part of a path without its unit, and the unit."""
    found = _IN_NAME.match(path.strip())
    name, unit = (found["name"], found["unit"]) if found else (path.strip(), "")
    parent, _, own = name.rpartition(".")
    if own.isdigit() and parent:  # an element of an array, as xyz.0
        own = f"{parent.rpartition('.')[2]}.{own}"
    return own, unit


def _unit(text: str) -> str:
    text = text.strip("[]() ")
    if not text:
        return ""
    for written in (text, _SUFFIXES.get(text.lower(), ""), text.lower()):
        if written and units.is_known(written):
            return written
    return ""

"""Mapping: every mistake is rejected, and the message names its key."""

from __future__ import annotations

import pytest

from flexsid.errors import BadInput
from flexsid.importers.mapping import MappingFile, parse_aircraft, parse_mapping
from flexsid.importers.table import MappingTable
from flexsid.workflow.aircraft.aircraft_models import list_default_outputs

GOOD = """
[aircraft]
name = "X-1"

[flight]
number = 3
date = "2026-05-31"

[maneuver]
label = "sweep"

[maneuver.condition]
airspeed = { value = 45.0, unit = "kt" }
altitude = { value = 1000.0, unit = "ft" }
fuel_fraction = { value = 0.5 }

[time]
column = "t_s"

[[channels]]
column = "elevator"
name = "wf1s"
unit = "deg"
role = "input"
sign = -1

[[channels]]
column = "q"
unit = "deg/s"
role = "output"
"""


def test_a_good_mapping_is_read() -> None:
    mapping = parse_mapping(GOOD)
    assert mapping.maneuver is not None
    assert [rule.template for rule in mapping.channels] == ["wf1s", "q"]
    assert mapping.channels[0].sign == -1.0
    assert mapping.flight is not None
    assert mapping.flight.number == 3


def test_a_mapping_states_how_well_its_airspeed_is_known() -> None:
    text = GOOD.replace("[time]", "airspeed_std = { value = 0.005 }\n\n[time]")
    mapping = parse_mapping(text)
    assert mapping.maneuver is not None
    assert mapping.maneuver.condition["airspeed_std"].value == 0.005


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("number = 3", "numbr = 3", "'flight.numbr' is not a key.*'number'"),
        ("number = 3", "", "'flight.number' is missing; expected the number of the flight"),
        ("number = 3", 'number = 3\nnumer = "x"', "'flight.numer' is not a key.*'number'"),
        ("number = 3", 'number = "three"', "'flight.number' must be a whole number"),
        ('"2026-05-31"', '"31 May"', "'flight.date' must have the form"),
        ('unit = "deg"\n', 'unit = "degs"\n', r"'channels\[1\].unit'.*Unknown unit 'degs'"),
        ('unit = "kt"', 'unit = "kg"', "'maneuver.condition.airspeed.unit' measures mass"),
        ('unit = "kt"', 'unit = "kn"', "'maneuver.condition.airspeed.unit'.*Unknown unit 'kn'"),
        ("value = 45.0", "value = nan", "'maneuver.condition.airspeed.value' must be a finite"),
        ("airspeed =", "speed =", "'maneuver.condition.speed' is not a key"),
        (
            'role = "input"',
            'role = "surface"',
            "'channels.1..role' must be 'input', 'output'.*'sur",
        ),
        ("sign = -1", "sign = 2", "'channels.1..sign' must be 1 or -1"),
        ('column = "t_s"', "rate = 50", "'time.rate' must be a table"),
        ('name = "X-1"', "", "'aircraft.name' is missing"),
        ("[flight]", "[flight", "not valid TOML"),
        ("[flight]", "[[flight]]", r"'flight' must be a table, found \[\{"),
        ("[[channels]]", "[channels]", "not valid TOML|must be an array of tables"),
        ("number = 3", "number = 3_000_000_000", "'flight.number' must be at most 2147483647"),
        ("number = 3", "number = true", "'flight.number' must be a whole number.*found True"),
        ('name = "X-1"', "name = 1", "'aircraft.name' must be a text, found 1"),
        (', unit = "kt" }', "}", "'maneuver.condition.airspeed.unit' is missing; expected a unit"),
        ("value = 45.0", 'value = 45.0, field = "v"', "airspeed.field' cannot be given besides"),
        ("value = 45.0", "value = 1e9", "'maneuver.condition.airspeed.value' holds .* not a speed"),
        ('unit = "deg"\n', "unit = 1\n", r"'channels\[1\].unit' must be a text or a table"),
        ('unit = "deg"\n', 'unit = { a = "x" }\n', r"'channels\[1\].unit.a' is not valid"),
        ("sign = -1", "labels = 3", r"'channels\[1\].labels' must be a text or a list, found 3"),
        ("sign = -1", 'confirmed = ["no"]', r"'channels\[1\].confirmed\[1\]' must be 'too-large'"),
        ('label = "sweep"', 'fta = { field = "a", values = { b = 3 } }', "fta.values.b' must be a"),
        ('label = "sweep"', 'label = "sweep"\nguessed = ["x"]', "'maneuver.guessed' names 'x'"),
    ],
)
def test_a_mistake_is_named(old: str, new: str, message: str) -> None:
    assert old in GOOD
    with pytest.raises(BadInput, match=message):
        parse_mapping(GOOD.replace(old, new))


def list_models(base: type[MappingTable]) -> list[type[MappingTable]]:
    return [base, *(model for own in base.__subclasses__() for model in list_models(own))]


def test_every_key_is_described() -> None:
    models = list_models(MappingTable)
    assert len(models) > 20
    for model in models:
        assert model.__doc__
        assert all(field.description for field in model.model_fields.values()), model
    assert "the reference chord" in str(MappingFile.model_json_schema())


def test_unconfirmed_keys_are_listed() -> None:
    text = GOOD.replace("value = 45.0", 'value = 45.0, guessed = ["unit"]')
    text = text.replace("number = 3", 'number = 3\nguessed = ["number"]')
    guessed = [(own.path, own.value) for own in parse_mapping(text).guessed]
    assert guessed == [("flight.number", 3), ("maneuver.condition.airspeed.unit", "kt")]


def test_a_mapping_of_nothing_is_refused() -> None:
    with pytest.raises(BadInput, match="there is nothing to import"):
        parse_mapping('[aircraft]\nname = "X-1"\n')


def test_a_maneuver_needs_its_flight() -> None:
    text = GOOD.replace('[flight]\nnumber = 3\ndate = "2026-05-31"\n', "")
    with pytest.raises(BadInput, match="'flight' is missing"):
        parse_mapping(text)


KITE = """
[aircraft]
name = "Kite"
[aircraft.geometry]
area = { value = 1.0, unit = "m2" }
chord = { value = 0.3, unit = "m" }
span = { value = 3.0, unit = "m" }
[aircraft.mass]
fuel = [0.0, 1.0]
mass = { values = [10.0, 12.0], unit = "kg" }
pitch_inertia = { values = [1.0, 1.2], unit = "kg*m2" }
x_cg = { values = [0.4, 0.5], unit = "m" }
[[aircraft.surfaces]]
name = "bfs"
instrument = "pot"
noise_std = { value = 0.02, unit = "deg" }
[[aircraft.sensors]]
name = "q"
kind = "gyro"
noise_std = 0.001
[aircraft.instruments.pot]
delay = { value = 4.0, unit = "ms" }
elements = [
  { type = "butterworth", order = 6, corner = { value = 40.0, unit = "Hz" } },
  { type = "second-order", damping = 0.7, natural_frequency = { value = 10.0, unit = "Hz" } },
]
[aircraft.polar]
cd_min = 0.02
oswald = 0.9
aspect_ratio = 9.0
lift_slope = 5.0
[aircraft.flutter]
fuel = [0.0, 1.0]
speed = { values = [50.0, 48.0], unit = "m/s" }
"""


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("area = { value = 1.0", "area = { value = -1.0", "geometry.area"),
        ("value = 0.3", "value = 0", "geometry.chord"),
        ("value = 3.0", "value = -3.0", "geometry.span"),
        ("fuel = [0.0, 1.0]\nmass", "fuel = [0.0, 100.0]\nmass", "mass.fuel"),
        ("fuel = [0.0, 1.0]\nspeed", "fuel = [1.0, 0.0]\nspeed", "flutter.fuel"),
        ("[50.0, 48.0]", "[50.0, -48.0]", "flutter.speed"),
        ("value = 0.02", "value = -0.02", r"surfaces\[1\].noise_std"),
        ("noise_std = 0.001", "noise_std = 0.0", r"sensors\[1\].noise_std"),
        ("value = 4.0", "value = -4.0", "instruments.pot.delay"),
        ("order = 6", "order = 0", r"instruments.pot.elements\[1\].order"),
        ("value = 40.0", "value = -40.0", r"instruments.pot.elements\[1\].corner"),
        ("damping = 0.7", "damping = -0.7", r"instruments.pot.elements\[2\].damping"),
        ("value = 10.0", "value = 0", r"instruments.pot.elements\[2\].natural_frequency"),
        ("cd_min = 0.02", "cd_min = -0.02", "polar.cd_min"),
        ("oswald = 0.9", "oswald = 0", "polar.oswald"),
        ("aspect_ratio = 9.0", "aspect_ratio = -9.0", "polar.aspect_ratio"),
        ("lift_slope = 5.0", "lift_slope = -5.0", "polar.lift_slope"),
    ],
)
def test_values_that_no_aircraft_has_are_refused(old: str, new: str, key: str) -> None:
    assert old in KITE
    parse_aircraft(KITE)
    with pytest.raises(BadInput, match=f"'aircraft.{key}' (must|and)"):
        parse_aircraft(KITE.replace(old, new))


PAIRS = """
[aircraft]
name = "Kite"
pairs = ["symmetric", "antisymmetric"]
[aircraft.geometry]
area = { value = 1.0, unit = "m2" }
chord = { value = 0.3, unit = "m" }
span = { value = 3.0, unit = "m" }
[aircraft.mass]
fuel = [0.0]
mass = { values = [10.0], unit = "kg" }
pitch_inertia = { values = [1.0], unit = "kg*m2" }
x_cg = { values = [0.5], unit = "m" }
[[aircraft.surfaces]]
name = "bfs"
""" + "".join(
    f'[[aircraft.sensors]]\nname = "{name}"\nkind = "accelerometer"\naxis = "{axis}"\n'
    f'point = "{name}"\nlocation = {{ values = [0, 0, 0], unit = "m" }}\n'
    for name, axis in (("az_tipl", "z"), ("az_tipr", "z"), ("ay_tipl", "y"), ("ay_tipr", "y"))
)


def test_parts_of_left_and_right_follow_their_sign_rule() -> None:
    part = parse_mapping(PAIRS + GOOD.replace('[aircraft]\nname = "X-1"\n', "")).aircraft
    assert part is not None
    assert part.definition is not None
    assert {c.name: dict(c.terms) for c in part.definition.combinations} == {
        "az_tips": {"az_tipl": 0.5, "az_tipr": 0.5},
        "ay_tips": {"ay_tipl": 0.5, "ay_tipr": -0.5},
        "az_tipa": {"az_tipl": -0.5, "az_tipr": 0.5},
        "ay_tipa": {"ay_tipl": 0.5, "ay_tipr": 0.5},
    }
    recorded = ["az_tipl", "az_tipr", "ay_tipl", "ay_tipr"]
    assert list_default_outputs(part.definition, recorded) == ("az_tips", "ay_tips")
    with pytest.raises(BadInput, match=r"'aircraft\.pairs\[2\]' must be 'symmetric' or"):
        parse_mapping(PAIRS.replace('"antisymmetric"', '"both"') + GOOD[GOOD.index("[flight]") :])

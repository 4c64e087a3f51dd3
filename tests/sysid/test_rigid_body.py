"""One value for the rigid body: names, counts and known terms of each axis."""

from __future__ import annotations

import pickle

import pytest

from flexsid.errors import BadInput
from flexsid.sysid.model.derivatives import RIGID_BODIES, list_derivative_names, parse_derivative
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.longitudinal import LONGITUDINAL

INPUTS = ("a", "b", "c", "d", "e")


@pytest.mark.parametrize(
    ("body", "counts"), [(LONGITUDINAL, (14, 27, 44, 65, 90)), (LATERAL, (24, 40, 60, 84, 112))]
)
def test_the_number_of_derivatives_follows_from_axis_modes_and_inputs(body, counts):
    for n, expected in enumerate(counts):
        names = list_derivative_names(tuple(range(7, 7 + n)), INPUTS, body)
        assert len(names) == len(set(names)) == expected
        assert all("_".join(parse_derivative(name)) == name for name in names)


def test_roll_and_lift_coefficients_differ_in_case():
    assert parse_derivative("Cl_p") == ("Cl", "p")
    with pytest.raises(BadInput, match="is not a derivative"):
        parse_derivative("CL_alpha")


def test_a_rigid_body_is_equal_after_a_worker_process_received_it():
    for body in RIGID_BODIES.values():
        assert pickle.loads(pickle.dumps(body)) == body

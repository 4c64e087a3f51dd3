"""Joint priors: the posterior of one record is worth the record, and their bounds hold."""

from __future__ import annotations

import numpy as np
import pytest
from tests.sysid.conftest import add_noise

from flexsid.errors import BadInput
from flexsid.sysid.estimation.likelihood import FitSettings, maximize
from flexsid.sysid.estimation.priors import (
    JointCovariance,
    Priors,
    build_information,
    factor_information,
    name_priors,
)

OMEGA = 2.0 * np.pi * np.arange(6, 86) / 24.0


@pytest.fixture
def joint() -> JointCovariance:
    root = np.random.default_rng(1).normal(size=(4, 4)) * np.array([[1.0], [10.0], [0.1], [1.0]])
    return JointCovariance(("a", "b", "c", "d"), root @ root.T)


def test_information_is_half_of_the_inverse_in_any_order_with_independent_priors_beside(joint):
    priors = Priors({**dict.fromkeys(joint.names, (0.0, 1.0)), "e": (0.0, 0.5)}, joint)
    information = build_information(("d", "free", "e", "b", "a", "c"), priors)
    covariance = np.linalg.inv(2.0 * information[np.ix_([0, 3, 4, 5], [0, 3, 4, 5])])
    order = [joint.names.index(name) for name in "dbac"]
    assert covariance == pytest.approx(joint.covariance[np.ix_(order, order)], rel=1e-9)
    assert information[2, 2] == pytest.approx(2.0)
    assert np.count_nonzero(information[1]) == 0
    left = factor_information(information)
    assert left.shape == (6, 5)
    assert left @ left.T == pytest.approx(information, rel=1e-9, abs=1e-12)


def test_a_part_of_a_joint_prior_is_its_marginal_and_a_singular_one_is_refused(joint):
    part = Priors({"a": (0.0, 1.0), "c": (0.0, 1.0)}, joint)
    information = build_information(("a", "c"), part)
    assert np.linalg.inv(2.0 * information) == pytest.approx(
        joint.covariance[np.ix_([0, 2], [0, 2])], rel=1e-9
    )
    singular = JointCovariance(("a", "c"), np.ones((2, 2)))
    with pytest.raises(BadInput, match="singular"):
        build_information(("a", "c"), Priors(part, singular))


def test_independent_priors_are_an_upper_bound_of_joint_ones(joint):
    priors = Priors(dict.fromkeys(joint.names, (1.0, 1.0)), joint)
    widened = priors.widen_to_independent()
    bound = np.diag([widened[name][1] ** 2 for name in joint.names])
    std = np.sqrt(np.diag(joint.covariance))
    assert np.linalg.eigvalsh((bound - joint.covariance) / np.outer(std, std)).min() > -1e-12
    assert {mean for mean, _ in widened.values()} == {1.0}


def test_only_the_same_joint_prior_has_the_same_error(joint):
    priors = dict.fromkeys(joint.names, (0.0, 1.0))
    other = JointCovariance(joint.names, 2.0 * joint.covariance)
    names = [name_priors(("b", "a"), Priors(priors, one)) for one in (joint, joint, other)]
    assert names[0] == names[1]
    assert not set(names[0]) & set(names[2])


def test_the_posterior_of_one_record_is_worth_that_record(make_case):
    """A fit with it as prior has the estimates and errors of both records together."""
    case = make_case(1)
    rng = np.random.default_rng(3)

    def fly():
        u, y = case.spectra(int(rng.integers(1000)), OMEGA)
        return case.experiment(u, add_noise(y, 0.02, rng), OMEGA)

    first, second = fly(), fly()
    free = case.free()
    before, both = maximize([first], free), maximize([first, second], free)
    rows = zip(before.names, before.values.tolist(), before.std_errors.tolist(), strict=True)
    priors = {name: (mean, std) for name, mean, std in rows}
    joint = JointCovariance(before.names, before.corrected_covariance)
    found = maximize([second], free, FitSettings(priors=Priors(priors, joint)))
    assert found.std_errors == pytest.approx(both.std_errors, rel=0.25)
    assert np.median(found.std_errors / both.std_errors) == pytest.approx(1.0, abs=0.05)
    assert np.abs((found.values - both.values) / both.std_errors).max() < 0.5
    assert np.median(found.std_errors / before.std_errors) < 0.8

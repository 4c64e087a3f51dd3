"""Priors of the parameters of a fit: independent ones, and a joint one such as a posterior."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from jaxtyping import Float

from flexsid.errors import BadInput

Prior = tuple[float, float]
"""Mean and standard deviation."""


@dataclass(frozen=True, slots=True)
class JointCovariance:
    """Covariance of the errors of several prior means, as those that one record has left."""

    names: tuple[str, ...]
    covariance: Float[np.ndarray, "n n"]

    def select(self, names: Iterable[str]) -> JointCovariance:
        """Return that of some of them: the others are marginalised."""
        wanted = set(names)
        own = [k for k, name in enumerate(self.names) if name in wanted]
        return JointCovariance(tuple(self.names[k] for k in own), self.covariance[np.ix_(own, own)])

    def drop(self, names: Iterable[str]) -> JointCovariance:
        """Return that of the others."""
        dropped = set(names)
        return self.select(name for name in self.names if name not in dropped)


class Priors(dict[str, Prior]):
    """Mean and standard deviation by parameter; the errors of those in ``joint`` are correlated."""

    def __init__(self, priors: Mapping[str, Prior], joint: JointCovariance | None = None) -> None:
        super().__init__(priors)
        self.joint = None if joint is None else joint.select(self)

    def select(self, names: Iterable[str]) -> Priors:
        """Return those of some parameters."""
        wanted = set(names)
        return Priors({name: one for name, one in self.items() if name in wanted}, self.joint)

    def widen_to_independent(self) -> dict[str, Prior]:
        """Return independent priors whose covariance is an upper bound of the joint one.

        Notes
        -----
        D - C is diagonally dominant, and so positive semidefinite, for
        D_ii = s_i sum_j |rho_ij| s_i: an estimate with the prior D has no larger errors than stated
        where the errors of the means have the covariance C.
        Source: Horn and Johnson, Matrix Analysis, sec. 6.1 (Gershgorin),
        doi:10.1017/CBO9780511810817.
        """
        found = dict(self)
        if self.joint is not None and self.joint.names:
            std = np.sqrt(np.diag(self.joint.covariance))
            correlation = np.abs(self.joint.covariance) / np.outer(std, std)
            widened = std * np.sqrt(correlation.sum(axis=1))
            for name, own in zip(self.joint.names, widened.tolist(), strict=True):
                found[name] = (self[name][0], own)
        return found


def build_information(
    names: Sequence[str], priors: Mapping[str, Prior] | None
) -> Float[np.ndarray, "n_theta n_theta"]:
    """Build the information 1/2 C^-1 of priors with the covariance C; zero without a prior.

    Half of the inverse, as the normal matrix N has the covariance 1/2 N^-1. Priors of other
    parameters than ``names`` are not in it.

    Raises
    ------
    BadInput
        If a joint covariance is singular.
    """
    known = priors or {}
    information = np.diag([0.5 * known[n][1] ** -2.0 if n in known else 0.0 for n in names])
    joint = getattr(priors, "joint", None)
    if joint is None:
        return information
    joint = joint.select(names)
    place = [names.index(name) for name in joint.names]
    std = np.sqrt(np.diag(joint.covariance))
    try:
        factor = scipy.linalg.cho_factor(joint.covariance / np.outer(std, std))
    except np.linalg.LinAlgError as error:
        raise BadInput(
            "the joint prior has a singular covariance; write back a posterior whose parameters "
            "are identifiable",
            code="bad-prior",
        ) from error
    scaled = scipy.linalg.cho_solve(factor, np.eye(std.size))
    information[np.ix_(place, place)] = 0.25 * (scaled + scaled.T) / np.outer(std, std)
    return information


def factor_information(
    information: Float[np.ndarray, "n_theta n_theta"],
) -> Float[np.ndarray, "n_theta n_held"]:
    """Factor the information of priors as L L^T, with a column for every parameter with a prior.

    Column k concerns the k-th of these and later ones; of an independent prior it alone.
    """
    held = np.flatnonzero(np.diag(information))
    size = np.sqrt(np.diag(information)[held])
    scaled = information[np.ix_(held, held)] / np.outer(size, size)
    left = np.zeros((len(information), held.size))
    left[held] = size[:, None] * scipy.linalg.cholesky(scaled, lower=True) if held.size else 0.0
    return left


def name_priors(names: Sequence[str], priors: Mapping[str, Prior] | None) -> tuple[str, ...]:
    """Name the columns of ``factor_information``: equal names have the same error."""
    known = priors or {}
    joint = getattr(priors, "joint", None)
    ends = dict.fromkeys(known, "")
    if joint is not None:
        own = joint.select(names)
        order = [own.names.index(name) for name in names if name in own.names]
        content = own.covariance[np.ix_(order, order)].tobytes()
        digest = hashlib.sha256(content).hexdigest()[:16]
        ends |= dict.fromkeys(own.names, f", jointly {digest}")
    return tuple(f"{n} about {known[n][0]:.9g}{ends[n]}" for n in names if n in known)

"""Speeds at which the roots of a flutter analysis become unstable."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid.records.flutter_summary import FlutterPoint, Instability

NEUTRAL = 1e-4
"""Structural damping g: below it a root is neutral, as an undamped mode in vacuo."""

RIGID_BODY_OMEGA = 2.0 * np.pi * 0.05
"""rad/s: a root closer to the origin is a rigid-body motion or round-off."""

_RISING = 1e-3
"""1/s: a root that grows more slowly (doubling in 700 s) is neutral."""

_JUMP = 0.25
"""Largest relative change in frequency of one root between rows."""

_DENSITY_SWEEPS = ("PKNL", "PKNLS")
_WITHOUT_ONSET = ("K",)


@dataclass(frozen=True, slots=True, eq=False)
class SweptRoot:
    """One root of one analysis, in the order of its sweep; arrays (n,)."""

    number: int
    airspeed: np.ndarray
    damping: np.ndarray
    omega: np.ndarray
    growth: np.ndarray
    density: np.ndarray
    mach: np.ndarray

    @property
    def is_neutral(self) -> bool:
        """Whether the root stays undamped or within 0.05 Hz of the origin."""
        size = np.hypot(self.growth, self.omega)
        return bool((np.abs(self.damping) < NEUTRAL).all() or (size < RIGID_BODY_OMEGA).all())

    def compute_excess(self, g: float) -> np.ndarray:
        """Return the damping beyond a structural damping g, which does not hold static motions."""
        return self.damping - np.where(self.omega < RIGID_BODY_OMEGA, 0.0, g)


def select_roots(arrays: dict[str, np.ndarray], method: str) -> list[SweptRoot]:
    """Return the roots of one analysis, each in the order of its sweep.

    Rows are taken by rising airspeed; in sweeps of matched points (PKNL) in the order printed,
    reversed where dynamic pressure falls, as their airspeeds need not rise.
    """
    return [_select_root(arrays, int(number), method) for number in np.unique(arrays["root"])]


def find_instabilities(
    arrays: dict[str, np.ndarray], title: str, method: str, g: float = 0.0
) -> tuple[list[FlutterPoint], list[str]]:
    """Find the speeds at which roots of one analysis become unstable; return points and notes.

    Parameters
    ----------
    arrays
        As stored in a FlutterSummary, of one analysis.
    title, method
        Description of the analysis, and its solution method.
    g
        Structural damping that the structure is assumed to have. [1]

    Notes
    -----
    Damping is interpolated by a straight line between the rows on either side of ``g``, and of
    zero for static motions.
    """
    if method in _WITHOUT_ONSET:
        return [], [f"no speed is read, since method {method} does not follow its roots."]
    points: list[FlutterPoint] = []
    neutral: list[int] = []
    notes: list[str] = []
    for root in select_roots(arrays, method):
        if root.is_neutral:
            rising = float(root.growth.max())
            if rising < _RISING or (root.damping < NEUTRAL).all():
                neutral.append(root.number)
            else:
                notes.append(
                    f"root {root.number} grows slowly, doubling in {np.log(2.0) / rising:.3g} s "
                    "or longer (within 0.05 Hz of the origin, a motion of the free body): no "
                    "speed is read from it."
                )
            continue
        excess = root.compute_excess(g)
        slow = np.hypot(root.growth, root.omega) < RIGID_BODY_OMEGA
        state = np.where((np.abs(excess) < NEUTRAL) | slow, 0, np.sign(excess)).astype(int)
        before = 0
        for row in range(state.size):
            if state[row] > 0 and before <= 0:
                points.append(_interpolate_onset(root, excess, row, before, title, notes))
            before = int(state[row]) or before
    if neutral:
        listed = ", ".join(map(str, neutral))
        notes.append(f"roots {listed} stay neutral or slow: no speed is read from them.")
    return points, notes


def _interpolate_onset(
    root: SweptRoot, excess: np.ndarray, row: int, before: int, title: str, notes: list[str]
) -> FlutterPoint:
    """Interpolate the speed at which a root becomes unstable between rows."""
    first, share = row, 0.0
    if before < 0:  # seen stable: the last row without growth lies on the other side of zero
        first = int(np.flatnonzero(excess[:row] <= 0)[-1])
        share = float(excess[first] / (excess[first] - excess[first + 1]))
    after = first + 1 if before < 0 else row

    def at(values: np.ndarray) -> float:
        return float(values[first] + share * (values[after] - values[first]))

    kind = Instability.DIVERGENCE if root.omega[after] < RIGID_BODY_OMEGA else Instability.FLUTTER
    omega = at(root.omega)
    if kind is Instability.DIVERGENCE:
        omega = 0.0
    elif root.omega[first] < RIGID_BODY_OMEGA:
        omega = float(root.omega[after])
    larger = float(max(root.omega[first], root.omega[after]))
    if abs(float(root.omega[after] - root.omega[first])) > max(_JUMP * larger, RIGID_BODY_OMEGA):
        notes.append(
            f"root {root.number} changes from {root.omega[first] / (2.0 * np.pi):.3g} to "
            f"{root.omega[after] / (2.0 * np.pi):.3g} Hz between {root.airspeed[first]:.4g} and "
            f"{root.airspeed[after]:.4g} m/s, where it becomes unstable: roots may be exchanged "
            "there; check with a finer sweep."
        )
    density, mach = at(root.density), at(root.mach)
    return FlutterPoint(
        root=root.number,
        airspeed_m_s=at(root.airspeed),
        omega_rad_s=omega,
        kind=kind,
        is_bound=before >= 0,
        analysis=title,
        mach=mach if np.isfinite(mach) else None,
        density_ratio=density if np.isfinite(density) else None,
    )


def _select_root(arrays: dict[str, np.ndarray], number: int, method: str) -> SweptRoot:
    rows = np.flatnonzero(arrays["root"] == number)
    speed = arrays["airspeed"][rows]
    if method in _DENSITY_SWEEPS:
        pressure = arrays["density"][rows] * speed**2
        order = rows if pressure[-1] >= pressure[0] else rows[::-1]
    elif method == "KE":
        order = rows if speed[-1] >= speed[0] else rows[::-1]
    else:
        order = rows[np.argsort(speed, kind="stable")]
    return SweptRoot(
        number,
        *(arrays[name][order] for name in ("airspeed", "damping", "omega", "growth")),
        *(arrays[name][order] for name in ("density", "mach")),
    )

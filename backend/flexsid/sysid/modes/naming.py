"""Names of modes by rule (SW1B, AW1T, SFA, SWL ...), with the reason for each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import cKDTree

from flexsid.sysid.modes.symmetry import find_symmetry

_RIGID_SHARE = 0.98  # of the motion: least share of the rigid-body motion in a rigid mode
_FORE_AFT_SHARE = 0.25  # of the wing's motion: least share in a fore-aft mode
_WINGLET_RATIO = 2.0  # mean square of the winglets over the wing: least ratio in a winglet mode
_LETTER = {True: "S", False: "A", None: ""}
_WORD = {True: "symmetric", False: "antisymmetric", None: "neither symmetric nor antisymmetric"}


@dataclass(frozen=True, slots=True)
class ModeName:
    """Name of a mode, its symmetry (None: not known), and the reason."""

    name: str
    symmetric: bool | None
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class _Motion:
    """Mean square motions of a wing, as shares of its own (sum 1), and of its winglets."""

    rigid: float
    fore_aft: float
    plunge: float
    twist: float
    winglet: float


def name_modes(
    nodes: Float[np.ndarray, "n_nodes 3"],
    translation: Float[np.ndarray, "n_modes n_nodes 3"],
    rotation: Float[np.ndarray, "n_modes n_nodes 3"] | None = None,
) -> tuple[ModeName, ...]:
    """Name modes, in order of frequency, by how wing and winglets move.

    Parameters
    ----------
    nodes
        x along the fuselage, y along the span, z up or down. [m]
    translation
        Per unit eta, in the axes of the nodes or turned about y. [m]
    rotation
        Gives the twist of beams, whose stations have one node each. [rad]

    Returns
    -------
    tuple of ModeName
        ``S`` or ``A``, then ``W`` with a running number and ``B`` (bending) or ``T``
        (torsion), ``FA`` (wing fore-aft) or ``WL`` (winglet lateral); ``R`` and a number
        for motions of the rigid body.

    Notes
    -----
    Source: Fig. 2 and the nomenclature, which name modes by the largest motion. The rule
    counts within each kind; analysts correct it where their programme differs.
    """
    symmetry = find_symmetry(nodes, translation)
    wing = _Wing.of(nodes)
    counts: dict[str, int] = {}
    names: list[ModeName] = []
    for mode, shape in enumerate(translation):
        symmetric = symmetry.is_symmetric(mode)
        motion = wing.motion(shape, None if rotation is None else rotation[mode, :, 1])
        kind, why = _classify_motion(motion)
        letter = "" if kind == "R" else _LETTER[symmetric]
        counts[letter + kind] = count = counts.get(letter + kind, 0) + 1
        if kind in ("B", "T"):
            name = f"{letter}W{count}{kind}"
        elif kind == "R":
            name = f"R{count}"
        else:
            name = f"{letter}{kind}" if count == 1 else f"{letter}{count}{kind}"
        names.append(ModeName(name, symmetric, f"{why}; {_WORD[symmetric]}"))
    return tuple(names)


def _classify_motion(motion: _Motion) -> tuple[str, str]:
    def percent(share: float) -> str:
        return f"{100.0 * share:.0f} %"

    if motion.rigid > _RIGID_SHARE:
        return "R", f"{percent(motion.rigid)} of the motion is that of a rigid body"
    if motion.winglet > _WINGLET_RATIO:
        return "WL", f"winglets move sideways {motion.winglet**0.5:.1f} times as far as the wing"
    if motion.fore_aft > _FORE_AFT_SHARE and motion.fore_aft > motion.plunge:
        return "FA", f"{percent(motion.fore_aft)} of the wing's motion is fore and aft"
    if motion.plunge >= motion.twist:
        return "B", f"{percent(motion.plunge)} of the wing's motion is bending"
    return "T", f"{percent(motion.twist)} of the wing's motion is twist"


@dataclass(frozen=True, slots=True, eq=False)
class _Wing:
    """Nodes sorted into stations along the span, and winglets at its ends."""

    nodes: Float[np.ndarray, "n_nodes 3"]
    station: Int[np.ndarray, " n_nodes"]  # -1 for what is not of the wing
    n_stations: int
    winglet: Bool[np.ndarray, " n_nodes"]
    winglet_root: Int[np.ndarray, " n_nodes"]  # nearest node of the wing
    chord: float  # that of a typical station [m]
    rigid: Float[np.ndarray, "n_dof n_rigid"]

    @classmethod
    def of(cls, nodes: Float[np.ndarray, "n_nodes 3"]) -> _Wing:
        y, z = nodes[:, 1], nodes[:, 2]
        span = max(float(np.ptp(y)), 1e-9)
        middle = 0.5 * (float(y.max()) + float(y.min()))
        outboard = np.abs(y - middle) > 0.45 * span
        winglet = outboard & (np.abs(z - np.median(z)) > 0.005 * span)
        order = np.argsort(y, kind="stable")
        step = np.diff(y[order]) > 0.004 * span
        station = np.empty(y.size, dtype=np.intp)
        station[order] = np.concatenate([[0], np.cumsum(step)])
        n_stations = int(station.max()) + 1
        station[winglet] = -1
        root = np.arange(y.size)
        if winglet.any() and not winglet.all():
            wing_nodes = np.flatnonzero(~winglet)
            nearest = cKDTree(nodes[wing_nodes]).query(nodes[winglet])[1]
            root[winglet] = wing_nodes[np.asarray(nearest)]
        spreads = [
            float(np.ptp(nodes[station == number, 0]))
            for number in range(n_stations)
            if (station == number).any()
        ]
        wide = [spread for spread in spreads if spread > 0.02 * span]
        chord = float(np.median(wide)) if wide else 0.1 * span
        return cls(nodes, station, n_stations, winglet, root, chord, _rigid_motions(nodes))

    def motion(
        self,
        shape: Float[np.ndarray, "n_nodes 3"],
        pitch: Float[np.ndarray, " n_nodes"] | None,
    ) -> _Motion:
        """Decompose one shape into the motions of rigid stations."""
        fore_aft, plunge, twist = [], [], []
        for number in range(self.n_stations):
            inside = np.flatnonzero(self.station == number)
            if inside.size == 0:
                continue
            x = self.nodes[inside, 0] - self.nodes[inside, 0].mean()
            u = shape[inside]
            heave = float(u[:, 2].mean())
            if np.ptp(x) > 0.2 * self.chord:
                slope = float(x @ (u[:, 2] - heave) / (x @ x))
                half = 0.5 * float(np.ptp(x))
            else:  # one node, or a few on a beam
                slope = 0.0 if pitch is None else float(pitch[inside].mean())
                half = 0.5 * self.chord
            fore_aft.append(float(u[:, 0].mean()))
            plunge.append(heave)
            twist.append(slope * half)
        squares = np.array([np.mean(np.square(part)) for part in (fore_aft, plunge, twist)])
        total = float(squares.sum())
        shares = squares / total if total > 0 else np.zeros(3)
        sideways = shape[self.winglet, 1] - shape[self.winglet_root[self.winglet], 1]
        winglet = float(np.mean(sideways**2)) / total if sideways.size and total > 0 else 0.0
        return _Motion(
            rigid=self._rigid_share(shape),
            fore_aft=float(shares[0]),
            plunge=float(shares[1]),
            twist=float(shares[2]),
            winglet=winglet,
        )

    def _rigid_share(self, shape: Float[np.ndarray, "n_nodes 3"]) -> float:
        """Share of the motion that six motions of a rigid body account for."""
        norm = float(np.sum(shape**2))
        return float(np.sum((self.rigid.T @ shape.ravel()) ** 2)) / norm if norm > 0 else 0.0


def _rigid_motions(nodes: Float[np.ndarray, "n_nodes 3"]) -> Float[np.ndarray, "n_dof n_rigid"]:
    """Orthonormal basis of the motions of a rigid body (fewer than six of a straight line)."""
    arm = nodes - nodes.mean(axis=0)
    motions = np.zeros((6, *nodes.shape))
    for axis in range(3):
        motions[axis, :, axis] = 1.0
        motions[3 + axis] = np.cross(np.eye(3)[axis], arm)
    flat = motions.reshape(6, -1)
    values, vectors = np.linalg.eigh(flat @ flat.T)
    held = values > 1e-9 * values[-1]
    return flat.T @ (vectors[:, held] / np.sqrt(values[held]))

"""Names of modes by rule (SW1B, AW1T, SFA, SWL ...), with the reason for each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy import linalg
from scipy.spatial import cKDTree

from flexsid.sysid.modes.shapes import find_symmetry, has_one_side

_OUTBOARD = 0.45  # of the span from its middle: winglets lie further out
_OFF_PLANE = 0.005  # of the span above or below the wing: nodes of a winglet
_STATION_GAP = 0.004  # of the span between neighbouring stations
_LEAST_CHORD = 0.02  # of the span: narrower stations are those of a beam
_RIGID_SHARE = 0.98  # of the motion: least share of the rigid-body motion in a rigid mode
_FIXED_RIGID_SHARE = 0.9999  # the same of a model with fixed nodes, which can only turn about them
_STILL = 1e-6  # of the largest motion of a mode: most of a node that is fixed
_FORE_AFT_SHARE = 0.25  # of the wing's motion: least share in a fore-aft mode
_WINGLET_RATIO = 2.0  # mean square of the winglets over the wing: least ratio in a winglet mode
_RANK_TOLERANCE = 3e-5  # of the largest singular value: rotation about a straight line is none
_OUTER = 0.3  # of the span from its middle: the wing alone reaches further out
_CHORD_MARGIN = 0.5  # of the outer chord, before and behind the edges extended inboard
_LEAST_NODES = 6  # of a part whose deformation is compared with that of the wing
_BRANCH_RATIO = 4.0  # mean square deformation of the other parts over that of the wing
_FAR_RATIO = 25.0  # the same of their motion as a whole: a tail may turn on a flexible fuselage
_LETTER = {True: "S", False: "A", None: ""}
_WORD = {
    True: "symmetric",
    False: "antisymmetric",
    None: "neither symmetric nor antisymmetric, symmetry unknown",
}


@dataclass(frozen=True, slots=True)
class ModeName:
    """Name of a mode, its symmetry (None: not known), and the reason."""

    name: str
    symmetric: bool | None
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class _Motion:
    """Mean square motions of a wing, as shares of its own (sum 1), and of its winglets.

    ``rigid`` is the share of the whole motion that six motions of a rigid body account for,
    ``branch`` the mean square deformation of fuselage and tail over that of the wing, ``far`` that
    of their whole motion.
    """

    fore_aft: float
    plunge: float
    twist: float
    winglet: float
    rigid: float
    branch: float
    far: float


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
        for motions of the rigid body. A mode of fuselage or tail, which the rule does not
        distinguish, has no name.

    Notes
    -----
    Source: Fig. 2 and the nomenclature, which name modes by the largest motion. The rule
    counts within each kind; analysts correct it where their programme differs.
    """
    pitch = None if rotation is None else np.asarray(rotation[:, :, 1], dtype=float)
    motions = _measure_motions(nodes, translation, pitch)
    is_half = has_one_side(nodes)
    is_held = is_half or _has_fixed_nodes(translation, rotation)
    least = _FIXED_RIGID_SHARE if is_held else _RIGID_SHARE
    if not _resolves_rigid_motion(nodes, translation):
        least = np.inf
    counts: dict[str, int] = {}
    names: list[ModeName] = []
    for symmetric, motion in zip(find_symmetry(nodes, translation), motions, strict=True):
        kind, why = _classify_motion(motion, least)
        if kind != "R" and not np.ptp(nodes[:, 1]) > 0.0:
            kind, why = "", "no node lies beside the others: not known as a mode of the wing"
        if kind != "R":
            least = max(least, _FIXED_RIGID_SHARE)  # a suspension is softer than the structure
        word = "symmetry unknown" if is_half and symmetric is None else _WORD[symmetric]
        if not kind:
            names.append(ModeName("", symmetric, f"{why}; {word}"))
            continue
        letter = "" if kind == "R" else _LETTER[symmetric]
        counts[letter + kind] = count = counts.get(letter + kind, 0) + 1
        if kind in ("B", "T"):
            name = f"{letter}W{count}{kind}"
        elif kind == "R":
            name = f"R{count}"
        else:
            name = f"{letter}{kind}" if count == 1 else f"{letter}{count}{kind}"
        names.append(ModeName(name, symmetric, f"{why}; {word}"))
    return tuple(names)


def _has_fixed_nodes(
    translation: Float[np.ndarray, "n_modes n_nodes 3"],
    rotation: Float[np.ndarray, "n_modes n_nodes 3"] | None,
) -> bool:
    """Return whether some node neither moves nor turns in any mode."""
    parts = (translation,) if rotation is None else (translation, rotation)
    moves = [np.abs(part) > _STILL * np.abs(part).max(axis=(1, 2), keepdims=True) for part in parts]
    return not np.any(moves, axis=(0, 1, 3)).all()


def _resolves_rigid_motion(
    nodes: Float[np.ndarray, "n_nodes 3"], translation: Float[np.ndarray, "n_modes n_nodes 3"]
) -> bool:
    """Return whether there are measured motions enough to see that a body does not deform."""
    moves = np.any(translation != 0.0, axis=0).reshape(-1)
    basis = _build_rigid_basis(nodes)[moves]
    return int(moves.sum()) >= 2 * int(np.linalg.matrix_rank(basis, tol=_RANK_TOLERANCE))


def _classify_motion(motion: _Motion, least_rigid: float) -> tuple[str, str]:
    def percent(share: float) -> str:
        return f"{100.0 * share:.0f} %"

    if motion.rigid > least_rigid:
        return "R", f"{percent(motion.rigid)} of the motion is that of a rigid body"
    if motion.branch > _BRANCH_RATIO:
        return "", (
            f"fuselage and tail deform {motion.branch**0.5:.3g} times as much as the wing: not a "
            "mode of the wing"
        )
    if motion.far > _FAR_RATIO:
        return "", (
            f"fuselage and tail move {motion.far**0.5:.3g} times as far as the wing: not a mode of "
            "the wing"
        )
    if motion.winglet > _WINGLET_RATIO:
        return "WL", f"winglets move sideways {motion.winglet**0.5:.1f} times as far as the wing"
    if motion.fore_aft > _FORE_AFT_SHARE and motion.fore_aft > motion.plunge:
        return "FA", f"{percent(motion.fore_aft)} of the wing's motion is fore and aft"
    if motion.plunge >= motion.twist:
        return "B", f"{percent(motion.plunge)} of the wing's motion is bending"
    return "T", f"{percent(motion.twist)} of the wing's motion is twist"


def _measure_motions(
    nodes: Float[np.ndarray, "n_nodes 3"],
    translation: Float[np.ndarray, "n_modes n_nodes 3"],
    pitch: Float[np.ndarray, "n_modes n_nodes"] | None,
) -> list[_Motion]:
    """Decompose shapes into the motions of rigid stations along the wing, and of its winglets."""
    station, root = _find_stations(nodes)
    order = np.argsort(station, kind="stable")
    begins = np.flatnonzero(np.diff(station[order])) + 1
    on_wing = [own for own in np.split(order, begins) if own.size and station[own[0]] >= 0]
    chords = [float(np.ptp(nodes[own, 0])) for own in on_wing]
    span = max(float(np.ptp(nodes[:, 1])), 1e-9)
    wide = [chord for chord in chords if chord > _LEAST_CHORD * span]
    typical = float(np.median(wide)) if wide else 0.1 * span
    parts = []
    for own, chord in zip(on_wing, chords, strict=True):
        x = nodes[own, 0] - nodes[own, 0].mean()
        surge, heave = translation[:, own, 0].mean(axis=1), translation[:, own, 2].mean(axis=1)
        if chord > 0.2 * typical:
            half = 0.5 * chord
            slope = (translation[:, own, 2] - heave[:, None]) @ x / (x @ x)
        else:  # one node, or a few on a beam
            half = 0.5 * typical
            slope = np.zeros(heave.size) if pitch is None else pitch[:, own].mean(axis=1)
        parts.append([surge, heave, slope * half])
    n_modes = translation.shape[0]
    squares = np.square(parts).reshape(-1, 3, n_modes).sum(axis=0) / max(1, len(parts))
    total = squares.sum(axis=0)
    away = np.flatnonzero(station < 0)
    sideways = translation[:, away, 1] - translation[:, root[away], 1]
    lateral = np.square(sideways).sum(axis=1) / max(1, away.size)
    flat = translation.reshape(n_modes, -1)
    rigid = np.square(flat @ _build_rigid_basis(nodes)).sum(axis=1)
    rows = [*_divide(squares, total), _divide(lateral, total)]
    rows.append(_divide(rigid, np.einsum("ij,ij->i", flat, flat)))
    rows += _compare_branches(nodes, translation, station)
    return [_Motion(*row) for row in np.array(rows).T.tolist()]


def _compare_branches(
    nodes: Float[np.ndarray, "n_nodes 3"],
    translation: Float[np.ndarray, "n_modes n_nodes 3"],
    station: Int[np.ndarray, " n_nodes"],
) -> list[Float[np.ndarray, " n_modes"]]:
    """Mean square deformation and motion of fuselage and tail over the wing's; zero without them.

    They are the nodes before and behind the edges of the outer wing, extended inboard. A
    deformation is what remains of the motion of a part without its motion as a rigid body.
    """
    none = [np.zeros(translation.shape[0])] * 2
    y = nodes[:, 1]
    out = np.abs(y) if y.min() * y.max() < 0.0 else np.abs(y - y[np.argmin(np.abs(y))])
    half = float(out.max())
    outer = (station >= 0) & (out > 2.0 * _OUTER * half)
    if np.unique(np.round(out[outer], 6)).size < 2:
        return none
    slope, start = np.polyfit(out[outer], nodes[outer, 0], 1)
    behind = nodes[:, 0] - (start + slope * out)
    margin = _CHORD_MARGIN * max(float(np.ptp(behind[outer])), _LEAST_CHORD * half)
    is_wing = (behind >= behind[outer].min() - margin) & (behind <= behind[outer].max() + margin)
    branch = ~is_wing & (station >= 0)
    if branch.sum() < _LEAST_NODES or is_wing.sum() < _LEAST_NODES:
        return none
    deformation, motion = [], []
    for part in (branch, is_wing):
        flat = translation[:, part].reshape(translation.shape[0], -1)
        basis = _build_rigid_basis(nodes[part])
        rest = flat - (flat @ basis) @ basis.T
        deformation.append(np.square(rest).sum(axis=1) / int(part.sum()))
        motion.append(np.square(flat).sum(axis=1) / int(part.sum()))
    total = np.square(translation).sum(axis=(1, 2)) / nodes.shape[0]
    return [
        _divide(part, np.maximum(of_wing, 1e-6 * total)) for part, of_wing in (deformation, motion)
    ]


def _divide(part: np.ndarray, whole: Float[np.ndarray, " n_modes"]) -> np.ndarray:
    """Share of a whole, zero of nothing."""
    return np.divide(part, whole, out=np.zeros_like(part), where=whole > 0)


def _find_stations(
    nodes: Float[np.ndarray, "n_nodes 3"],
) -> tuple[Int[np.ndarray, " n_nodes"], Int[np.ndarray, " n_nodes"]]:
    """Station of every node along the wing, -1 on a winglet, and its nearest node of the wing."""
    y, z = nodes[:, 1], nodes[:, 2]
    span = max(float(np.ptp(y)), 1e-9)
    middle = 0.5 * (float(y.max()) + float(y.min()))
    winglet = (np.abs(y - middle) > _OUTBOARD * span) & (
        np.abs(z - np.median(z)) > _OFF_PLANE * span
    )
    order = np.argsort(y, kind="stable")
    station = np.empty(y.size, dtype=np.intp)
    station[order] = np.concatenate([[0], np.cumsum(np.diff(y[order]) > _STATION_GAP * span)])
    station[winglet] = -1
    root = np.arange(y.size)
    if winglet.any() and not winglet.all():
        wing_nodes = np.flatnonzero(~winglet)
        nearest = cKDTree(nodes[wing_nodes]).query(nodes[winglet])[1]
        root[winglet] = wing_nodes[np.asarray(nearest)]
    return station, root


def _build_rigid_basis(
    nodes: Float[np.ndarray, "n_nodes 3"],
) -> Float[np.ndarray, "n_dof n_rigid"]:
    """Orthonormal basis of the motions of a rigid body (fewer than six of a straight line)."""
    arm = nodes - nodes.mean(axis=0)
    motions = np.zeros((6, *nodes.shape))
    for axis in range(3):
        motions[axis, :, axis] = 1.0
        motions[3 + axis] = np.cross(np.eye(3)[axis], arm)
    return linalg.orth(motions.reshape(6, -1).T, rcond=_RANK_TOLERANCE)

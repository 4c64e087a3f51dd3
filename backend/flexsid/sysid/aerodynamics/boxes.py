"""Boxes of lifting surfaces: trapezia with two edges along the flow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated

import numpy as np
from jaxtyping import Float, Int

from flexsid.allowed import Allowed
from flexsid.errors import BadInput

Place = Annotated[float, Allowed(ge=-1000.0, le=1000.0)]
Corner = tuple[Place, Place, Place]
_Chord = Annotated[float, Allowed(ge=0.0, le=1000.0)]


@dataclass(frozen=True, slots=True)
class Trapezium:
    """A trapezium between two chords along X.

    ``left`` and ``right`` are the leading edges of the chords, left to right as seen from
    behind (of a winglet on the right: bottom to top) [length]. Ranges are those of requests,
    in metres.
    """

    left: Corner
    left_chord: _Chord
    right: Corner
    right_chord: _Chord


@dataclass(frozen=True, slots=True, eq=False)
class Panel(Trapezium):
    """A trapezium divided into boxes.

    ``chordwise`` and ``spanwise`` are the edges of the boxes as fractions, from 0 to 1.
    """

    chordwise: Float[np.ndarray, " n_chordwise"]
    spanwise: Float[np.ndarray, " n_spanwise"]

    def __post_init__(self) -> None:
        """Refuse a panel without area, or with divisions that do not rise from 0 to 1."""
        numbers = [*self.left, *self.right, self.left_chord, self.right_chord]
        if not np.isfinite(numbers).all():
            raise BadInput("a corner or chord of a panel is not a number", code="bad-panel")
        if min(self.left_chord, self.right_chord) < 0 or self.left_chord + self.right_chord <= 0:
            raise BadInput("the chords of a panel must be positive", code="bad-panel")
        if self.left[1:] == self.right[1:]:
            raise BadInput("a panel has no span between its two chords", code="bad-panel")
        for name in ("chordwise", "spanwise"):
            edges = getattr(self, name)
            rises = edges.size > 1 and bool((np.diff(edges) > 0.0).all())
            if not rises or edges[0] != 0.0 or edges[-1] != 1.0:
                raise BadInput(
                    f"the {name} divisions of a panel must rise from 0 to 1", code="bad-panel"
                )

    def scale(self, factor: float) -> Panel:
        """Return the panel in another unit of length."""
        (x, y, z), (x1, y1, z1) = self.left, self.right
        return replace(
            self,
            left=(factor * x, factor * y, factor * z),
            left_chord=factor * self.left_chord,
            right=(factor * x1, factor * y1, factor * z1),
            right_chord=factor * self.right_chord,
        )


@dataclass(frozen=True, eq=False)
class Boxes:
    """Boxes in the order of panels, then strips from left to right, then leading edge to aft.

    Corners are leading edge left, trailing edge left, trailing edge right, leading edge right
    [length]; ``panel`` and ``strip`` number the panel and the strip of every box.
    """

    corners: Float[np.ndarray, "n 4 3"]
    panel: Int[np.ndarray, " n"]
    strip: Int[np.ndarray, " n"]

    def __post_init__(self) -> None:
        """Refuse corners that are not numbers."""
        wrong = np.flatnonzero(~np.isfinite(self.corners).all(axis=(1, 2)))
        if wrong.size:
            box = int(wrong[0])
            raise BadInput(
                f"a corner of box {box + 1}, of panel {self.panel[box] + 1}, is not a number",
                code="bad-panel",
            )

    def __len__(self) -> int:
        """Return the number of boxes."""
        return self.corners.shape[0]

    @cached_property
    def vortex_left(self) -> Float[np.ndarray, "n 3"]:
        """Left end of the load line at 1/4 chord."""
        return 0.75 * self.corners[:, 0] + 0.25 * self.corners[:, 1]

    @cached_property
    def vortex_right(self) -> Float[np.ndarray, "n 3"]:
        """Right end of the load line at 1/4 chord."""
        return 0.75 * self.corners[:, 3] + 0.25 * self.corners[:, 2]

    @cached_property
    def load(self) -> Float[np.ndarray, "n 3"]:
        """Load points: 1/4 chord, mid-span."""
        return 0.5 * (self.vortex_left + self.vortex_right)

    @cached_property
    def control(self) -> Float[np.ndarray, "n 3"]:
        """Control points: 3/4 chord, mid-span."""
        leading, trailing = self.corners[:, [0, 3]], self.corners[:, [1, 2]]
        return (0.25 * leading + 0.75 * trailing).mean(axis=1)

    @cached_property
    def chord(self) -> Float[np.ndarray, " n"]:
        """Chord at mid-span."""
        return (self.corners[:, [1, 2], 0] - self.corners[:, [0, 3], 0]).mean(axis=1)

    @cached_property
    def span(self) -> Float[np.ndarray, " n"]:
        """Width across the flow."""
        return np.hypot(*(self.vortex_right - self.vortex_left)[:, 1:].T)

    @cached_property
    def area(self) -> Float[np.ndarray, " n"]:
        """Area of each box."""
        return self.chord * self.span

    @cached_property
    def normal(self) -> Float[np.ndarray, "n 3"]:
        """Unit normals: aft x span."""
        across = (self.vortex_right - self.vortex_left) / self.span[:, None]
        return np.stack([np.zeros(len(self)), -across[:, 2], across[:, 1]], axis=1)

    def mirrored(self) -> Boxes:
        """Return the boxes of the other side, numbered likewise, again from left to right."""
        return Boxes(
            self.corners[:, [3, 2, 1, 0]] * np.array([1.0, -1.0, 1.0]), self.panel, self.strip
        )


def mesh_panels(panels: Sequence[Panel]) -> Boxes:
    """Divide panels into boxes.

    Raises
    ------
    BadInput
        Without panels, or if a panel has no valid geometry.
    """
    if not panels:
        raise BadInput("a planform needs at least one panel", code="no-panels")
    corners, panel, strip, strips = [], [], [], 0
    for number, one in enumerate(panels):
        chords = one.left_chord + (one.right_chord - one.left_chord) * one.spanwise
        left, right = np.array(one.left), np.array(one.right)
        leading = left + (right - left) * one.spanwise[:, None]
        nodes = np.repeat(leading[:, None], one.chordwise.size, axis=1)
        nodes[..., 0] += chords[:, None] * one.chordwise
        boxes = np.stack([nodes[:-1, :-1], nodes[:-1, 1:], nodes[1:, 1:], nodes[1:, :-1]], axis=2)
        corners.append(boxes.reshape(-1, 4, 3))
        n_strips, n_boxes = one.spanwise.size - 1, one.chordwise.size - 1
        panel.append(np.full(n_strips * n_boxes, number))
        strip.append(strips + np.repeat(np.arange(n_strips), n_boxes))
        strips += n_strips
    return Boxes(np.concatenate(corners), np.concatenate(panel), np.concatenate(strip))

"""A ground vibration test of FLEX-28 on soft springs: simulated measured responses."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexsid.demo.flex28 import Truth, load_nodes
from flexsid.records.modal_data import MeasuredResponses

_BAND_HZ = (2.0, 30.0)
_STEP_HZ = 0.05
_NOISE = 0.01
_SHAKERS = ((1, "z"), (2, "z"), (1, "x"))
"""Tip (1 and 2) and direction of each shaker."""


def build_measured_responses(
    truth: Truth, aircraft_id: int, save: Callable[[np.ndarray], str]
) -> MeasuredResponses:
    """Return responses to shakers at the wing tips, at empty fuel and about sixty points."""
    places, shapes = load_nodes()
    modes = truth.modes.at(0.0)
    phi = np.asarray(shapes[0, :, :, :3], dtype=float) * np.array([-1.0, 1.0, -1.0])
    hertz = np.arange(*_BAND_HZ, _STEP_HZ)
    s = 2j * np.pi * hertz[:, None]
    gain = s**2 / (modes.mass * (s**2 + 2.0 * modes.zeta * modes.omega * s + modes.omega**2))
    nodes = np.arange(0, places.shape[0], 3)
    outputs = [(int(node), 2) for node in nodes]
    winglets = [int(node) for node in nodes if places[node, 2] > 0.1]
    outputs += [(node, 1) for node in winglets] + [(int(node), 0) for node in nodes[::3]]
    tips = np.argsort(np.abs(places[nodes, 1]))[-2:]
    shakers = [(int(nodes[tips[k - 1]]), "xyz".index(axis)) for k, axis in _SHAKERS]
    outputs += [shaker for shaker in shakers if shaker not in outputs]
    at = np.array([phi[:, node, axis] for node, axis in outputs])
    pushed = np.array([phi[:, node, axis] for node, axis in shakers])
    values = np.einsum("wm,om,rm->wor", gain, at, pushed)
    rng = np.random.default_rng(28)
    level = _NOISE * np.sqrt(np.mean(np.abs(values) ** 2, axis=0))
    noise = rng.normal(size=values.shape) + 1j * rng.normal(size=values.shape)
    values = values + level * noise / np.sqrt(2.0)
    return MeasuredResponses(
        aircraft_id=aircraft_id,
        name="GVT at empty fuel",
        fuel=0.0,
        quantity="acceleration",
        outputs=tuple(f"{node + 1}+{'xyz'[axis]}" for node, axis in outputs),
        references=tuple(f"{node + 1}+{'xyz'[axis]}" for node, axis in shakers),
        arrays={
            "frequency": save(hertz),
            "values": save(values),
            "nodes": save(places[[node for node, _ in outputs]]),
            "directions": save(np.eye(3)[[axis for _, axis in outputs]]),
        },
        notes=("Responses are in m/s2/N.",),
        origin="synthetic, with one percent of noise",
    )

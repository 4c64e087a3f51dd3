"""A script of somebody who has only the documentation: it must type-check and run."""

from __future__ import annotations

import numpy as np

from flexsid.client import RequestRefused, RunFailed, Unreachable, Workbench
from flexsid.sysid import FrequencyData, TimeHistory, finite_fourier_transform


def transform(history: TimeHistory, frequencies_hz: list[float]) -> FrequencyData:
    """Transform a record to the frequency domain."""
    omega = 2.0 * np.pi * np.array(frequencies_hz)
    spectra = finite_fourier_transform(history.values, history.rate_hz, omega, history.start_s)
    return FrequencyData(omega, spectra, history.names)


def list_labels(workbench: Workbench) -> list[str]:
    """List the labels of all maneuvers; none without a server."""
    try:
        return [str(label) for label in workbench.maneuvers()["label"]]
    except (RequestRefused, RunFailed, Unreachable) as error:
        print(error)
        return []


time_s = np.arange(2000) / 100.0
record = TimeHistory(0.0, 100.0, np.sin(3.0 * np.pi * time_s)[:, None], ("q",))
data = transform(record, [0.5, 1.0, 1.5, 2.0])
assert np.argmax(np.abs(data.values[:, 0])) == 2
assert list_labels(Workbench("http://127.0.0.1:9")) == []

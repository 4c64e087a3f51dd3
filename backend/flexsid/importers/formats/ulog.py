"""ULog, the log of PX4, through pyulog, an extra (``pip install flexsid[ulog]``).

Format: https://docs.px4.io/main/en/dev_log/ulog_file_format. Every topic has its own time stamps.
"""

from __future__ import annotations

import contextlib
import os
import struct
from collections import Counter
from collections.abc import Iterator, Sized
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexsid.importers.source import NOT_READ, Field

if TYPE_CHECKING:
    from pyulog import ULog

_MAGIC = b"ULog\x01\x12\x35"
_CLOCKS = ("timestamp_sample", "timestamp")  # of the measurement, of the message
_QUATERNION = tuple(f"q[{k}]" for k in range(4))
_UNIT = 1e-2  # most difference of the size of a quaternion from one
_US = 1e-6
_FILE_HEADER = 16  # bytes
_MESSAGE = struct.Struct("<HB")  # size of the content and type


def recognises(head: bytes) -> bool:
    """Return whether the file has the magic number of ULog."""
    return head.startswith(_MAGIC)


def read(path: Path) -> Iterator[Field]:
    """Read the fields of all topics, such as ``vehicle_angular_velocity.xyz.0``.

    A further instance of a topic is called ``sensor_gyro.1``. The clock of a topic is the time of
    its measurements, else that of its messages, since the start of the autopilot. The file states
    no units. The quaternion of an attitude is read as roll, pitch and yaw besides.
    """
    from pyulog import ULog

    with open(os.devnull, "w") as discarded, contextlib.redirect_stdout(discarded):
        log = ULog(str(path))
    counts = Counter(topic.name for topic in log.data_list)
    for topic in log.data_list:
        name = topic.name
        if counts[name] > 1 and topic.multi_id:
            name = f"{name}.{topic.multi_id}"
        clock = next(key for key in _CLOCKS if key in topic.data)
        yield Field(f"{name}.{clock}", topic.data[clock].astype(np.float64) * _US, "s")
        for key, samples in topic.data.items():
            if key not in _CLOCKS and not key.startswith("_padding"):
                path_of_field = key.replace("[", ".").replace("]", "")
                yield Field(f"{name}.{path_of_field}", samples, "", f"{name}.{clock}")
        if all(key in topic.data for key in _QUATERNION):
            parts = np.stack([topic.data[key].astype(np.float64) for key in _QUATERNION])
            for angle, samples in _convert_quaternion(parts).items():
                yield Field(f"{name}.{angle}", samples, "rad", f"{name}.{clock}")
    left = [f"{what}: {len(held)}" for what, held in _list_others(log).items() if held]
    if log.file_corruption:
        left.append("damaged parts of the log, in which messages are missing")
    if _is_cut_off(path):
        left.append("the log ends within a message: what follows is missing")
    if left:
        yield Field(NOT_READ, np.array(left))


def _list_others(log: ULog) -> dict[str, Sized]:
    """Return what a log has besides topics."""
    multiple = log.msg_info_multiple_dict
    return {
        "parameters of the autopilot": log.initial_parameters,
        "changes of parameters": log.changed_parameters,
        "texts of the autopilot": [*log.logged_messages, *log.logged_messages_tagged],
        "descriptions of the autopilot": [*log.msg_info_dict, *multiple],
        "gaps of the recorder, in which samples are missing": log.dropouts,
    }


def _convert_quaternion(parts: np.ndarray) -> dict[str, np.ndarray]:
    """Return roll, pitch and yaw [rad] of quaternions (4, n); none if these are no rotations.

    Notes
    -----
    w, x, y, z turn body axes (forward, right, down) into north, east, down; angles in the order
    yaw, pitch, roll. Source: B. L. Stevens, F. L. Lewis, Aircraft Control and Simulation.
    """
    size = np.sqrt(np.square(parts).sum(axis=0))
    if not (np.abs(size - 1.0) < _UNIT).all():  # also of NaN
        return {}
    w, x, y, z = parts / size
    angles = {
        "roll": np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x**2 + y**2)),
        "pitch": np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0)),
        "yaw": np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y**2 + z**2)),
    }
    return {name: np.unwrap(values) for name, values in angles.items()}


def _is_cut_off(path: Path) -> bool:
    """Return whether the last message of a log is incomplete."""
    size = path.stat().st_size
    with path.open("rb") as file:
        at = file.seek(_FILE_HEADER)
        while len(head := file.read(_MESSAGE.size)) == _MESSAGE.size:
            at += _MESSAGE.size + _MESSAGE.unpack(head)[0]
            file.seek(at)
    return at != size

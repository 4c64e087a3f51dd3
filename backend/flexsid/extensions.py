"""Extensions: values that installed packages add by entry points.

A package names its values in its metadata, for example::

    [project.entry-points."flexsid.sensors"]
    pitch-acceleration = "flexsid_example:PITCH_ACCELERATION"

Their group states what they are: ``flexsid.sensors`` has ``SensorModel`` values,
``flexsid.importers`` ``FileFormat``, ``flexsid.estimators`` ``Estimator``,
``flexsid.receivers`` ``Receiver``, ``flexsid.truths`` ``SimulatedAircraft``,
``flexsid.models`` ``GreyBox``.
"""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from importlib.metadata import EntryPoint, entry_points
from typing import TypeVar

from flexsid.errors import FlexsidError

T = TypeVar("T")

SENSORS, IMPORTERS = "flexsid.sensors", "flexsid.importers"
ESTIMATORS, RECEIVERS = "flexsid.estimators", "flexsid.receivers"
TRUTHS, MODELS = "flexsid.truths", "flexsid.models"
"""Groups of entry points."""


class ExtensionFailed(FlexsidError):
    """An installed package that extends flexsid fails; the message has its name and version."""

    code = "extension-failed"


def load_extensions(group: str, kind: type[T]) -> tuple[tuple[str, str, T], ...]:
    """Load the values of a group: name, package such as ``flexsid-example 1.0``, and value.

    Raises
    ------
    ExtensionFailed
        If a value cannot be imported, or is of another type.
    """
    found: list[tuple[str, str, T]] = []
    for entry in sorted(entry_points(group=group), key=lambda one: one.name):
        package = _name_package(entry)
        with report_errors(package):
            value = entry.load()
        if not isinstance(value, kind):
            raise ExtensionFailed(
                f"the package {package} declares '{entry.value}' in '{group}': it is a "
                f"{type(value).__name__}, expected a {kind.__name__}",
                package=package,
            )
        found.append((entry.name, package, value))
    return tuple(found)


def list_extension_names(group: str) -> tuple[str, ...]:
    """List the names of the entry points of a group, without importing their packages."""
    return tuple(entry.name for entry in entry_points(group=group))


def find_extension_package(group: str, name: str) -> str | None:
    """Find the package of an entry point, such as ``flexsid-example 1.0``; it is not imported."""
    found = [entry for entry in entry_points(group=group) if entry.name == name]
    return _name_package(found[0]) if found else None


@contextmanager
def report_errors(package: str) -> Generator[None]:
    """Report any error in the block as one of the package; no package is flexsid itself.

    Raises
    ------
    ExtensionFailed
        In place of exceptions that are not reported to users.
    """
    try:
        yield
    except (FlexsidError, MemoryError):
        raise
    except Exception as error:
        if not package:
            raise
        raise ExtensionFailed(
            f"the package {package}, which extends flexsid, fails ({type(error).__name__}: "
            f"{error}); correct or uninstall it",
            package=package,
        ) from error


def _name_package(entry: EntryPoint) -> str:
    return entry.value if entry.dist is None else f"{entry.dist.name} {entry.dist.version}"

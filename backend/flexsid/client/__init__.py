"""Python client of a workbench for notebooks and scripts."""

from flexsid.client.connection import RequestRefused, RunFailed, Unreachable
from flexsid.client.workbench import Workbench

__all__ = ["RequestRefused", "RunFailed", "Unreachable", "Workbench"]

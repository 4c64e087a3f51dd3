"""A workbench from a notebook or script: HTTP in, tables, figures and models out."""

from flexsid.client.connection import Refused, Unreachable
from flexsid.client.waiting import RunFailed
from flexsid.client.workbench import Workbench

__all__ = ["Refused", "RunFailed", "Unreachable", "Workbench"]

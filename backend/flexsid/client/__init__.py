"""A workbench from a notebook or script: HTTP in, tables, figures and models out."""

from flexsid.client.connection import RequestRefused, Unreachable
from flexsid.client.waiting import RunFailed
from flexsid.client.workbench import Workbench

__all__ = ["RequestRefused", "RunFailed", "Unreachable", "Workbench"]

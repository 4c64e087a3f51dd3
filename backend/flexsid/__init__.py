"""flexsid: a workbench to identify flexible aircraft from flight test."""

__version__ = "0.1.0"

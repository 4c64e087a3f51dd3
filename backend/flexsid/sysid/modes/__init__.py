"""In-vacuo structural modes: one set at one fuel weight, and tables against fuel."""

from flexsid.sysid.modes.shapes import StructuralModes
from flexsid.sysid.modes.table import ModeTable

__all__ = ["ModeTable", "StructuralModes"]

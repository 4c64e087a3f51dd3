"""Modal data from files: their content, the options they require, modes in SI and body axes.

A file seldom states its unit of length, and never the unit of a generalised mass of one.
Both are required as options where no file states them, and stored: unit generalised mass in one
system of units is not unit in another, and generalised force coefficients depend on it.
"""

from flexsid.importers.modal_data.extraction import RawModalData, extract_modal_data
from flexsid.importers.modal_data.inspection import ModalFiles, inspect_modal_data
from flexsid.importers.modal_data.nodes import MassOptions, extract_mass_table
from flexsid.importers.modal_data.options import ModalDataOptions

__all__ = [
    "MassOptions",
    "ModalDataOptions",
    "ModalFiles",
    "RawModalData",
    "extract_mass_table",
    "extract_modal_data",
    "inspect_modal_data",
]

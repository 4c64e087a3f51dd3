"""Structures out of files: what they hold, what has to be asked, and modes in SI and body axes.

A file seldom says in which unit a length is, and never what a generalised mass of one is in.
Both are asked for where a file does not say, and kept: unit generalised mass in one system of
units is not unit in another, and generalised force coefficients depend on it.
"""

from flexsid.importers.modal_data.answers import StructureAnswers
from flexsid.importers.modal_data.extraction import RawStructure, extract_structure
from flexsid.importers.modal_data.found import ModalFiles, look_at_structure

__all__ = [
    "ModalFiles",
    "RawStructure",
    "StructureAnswers",
    "extract_structure",
    "look_at_structure",
]

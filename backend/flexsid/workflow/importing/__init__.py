"""Uploaded files to flights, maneuvers and excitations, all of an import or nothing."""

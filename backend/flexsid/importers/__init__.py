"""Importers: one reader per file format, one mapping that names and places what was read."""

"""Importers: one reader per file format, and the mapping of recorded columns to channels."""

"""Formats: one reader per file format, and the selection among them."""

"""Fits: what is computed from the task of a run, without a database."""

"""The analyst's steps: load, compute, keep."""

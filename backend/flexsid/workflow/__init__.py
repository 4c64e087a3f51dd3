"""The analyst's steps: load, compute, store."""

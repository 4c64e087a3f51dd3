"""Adequacy of an identified model: tests for remaining model error, held-out data, posterior."""

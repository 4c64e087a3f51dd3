"""Validation of identified models by data that they were not fitted to."""

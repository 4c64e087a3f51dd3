"""Recorded samples of a maneuver to conditioned time histories and spectra in SI."""

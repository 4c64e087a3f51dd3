"""Preparation of recordings: repair, resampling, sensor faults, motion filter."""

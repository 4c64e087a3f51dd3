"""Poles of identified models, and their change with airspeed."""

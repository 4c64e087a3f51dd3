"""Poles of identified models and what becomes of them with airspeed."""

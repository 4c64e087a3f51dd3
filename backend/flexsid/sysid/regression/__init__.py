"""Equation error: regression of coefficients on measured motion."""

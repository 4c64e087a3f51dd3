"""Estimators: output error, frequency response error, equation error."""

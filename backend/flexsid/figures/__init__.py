"""Plotly figures as plain data, from computed values."""

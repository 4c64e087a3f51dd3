"""Finished values to plotly figures as plain data: nothing is computed, nothing is loaded."""

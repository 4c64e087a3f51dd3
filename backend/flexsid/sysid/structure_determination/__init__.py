"""Model structure determination: which terms the data ask for."""

"""The aeroelastic model: condition, derivatives, sensors, instruments."""

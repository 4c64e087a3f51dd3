"""Modal data: tables of modes over fuel, their corrections, ground vibration tests."""

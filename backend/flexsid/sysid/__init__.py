"""The mathematics of flexsid: arrays and frozen values, free of web, database and plots."""

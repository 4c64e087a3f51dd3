"""Storage of records and arrays in SQLite or PostgreSQL, through ``Store``."""

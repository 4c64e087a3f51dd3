"""Keeps records and arrays: SQLite or PostgreSQL behind one door, ``Store``."""

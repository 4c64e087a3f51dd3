"""Copies of a database: backups, the samples that they share, and snapshots in memory."""

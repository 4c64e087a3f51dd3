"""Maintenance of a site: backups, integrity checks, printed reports, signed files."""

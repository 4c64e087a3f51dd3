"""Maneuvers and runs as pages list them: filtered, sorted, page by page."""

"""Execution of queued runs in worker processes."""

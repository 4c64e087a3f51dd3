"""Carries out queued runs in worker processes."""

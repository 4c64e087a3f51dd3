"""Verification of the installed software against published and exact values."""

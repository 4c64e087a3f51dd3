"""Fourier transforms and frequency responses."""

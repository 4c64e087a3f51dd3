"""Excitation designs: multisines, predicted accuracy, amplitudes, pre-flight simulation."""

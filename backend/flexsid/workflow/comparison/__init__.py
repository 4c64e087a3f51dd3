"""Comparison of derivatives between runs and with predictions."""

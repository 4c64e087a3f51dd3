"""Saved model structures by version, approved baselines, and stored run results."""

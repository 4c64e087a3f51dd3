"""A search for the structure of a model, by equation error or by likelihood.

Pure: prepared maneuvers in, candidates ranked by what they predict out.
"""

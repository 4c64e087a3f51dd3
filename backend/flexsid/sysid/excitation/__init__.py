"""Excitation: orthogonal multisines that move every surface at once, and what they will tell."""

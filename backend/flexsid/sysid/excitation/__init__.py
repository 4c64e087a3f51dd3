"""Excitation: orthogonal multisines that move every surface at once, and their information."""

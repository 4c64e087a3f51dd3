"""Data compatibility: flight-path reconstruction by kinematics, without aerodynamics."""

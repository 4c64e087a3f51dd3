"""Truth simulation of a flexible aircraft in closed loop, sample by sample."""

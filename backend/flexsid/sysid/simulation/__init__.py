"""Truth simulation: a flexible aircraft flown in closed loop, sample by sample."""

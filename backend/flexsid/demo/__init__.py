"""FLEX-28, the demonstration aircraft: flown in closed loop, recorded, stored."""

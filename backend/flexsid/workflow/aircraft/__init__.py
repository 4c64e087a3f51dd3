"""Aircraft records ready for analysis: axes, instruments, thrust, condition, predictions."""

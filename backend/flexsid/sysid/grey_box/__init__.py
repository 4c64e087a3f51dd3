"""Grey-box models: state-space matrices that are a function of parameters and flight condition."""

"""Global aerodynamic model: derivatives over the envelope from the estimates of all runs."""

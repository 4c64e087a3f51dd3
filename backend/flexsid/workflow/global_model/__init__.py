"""Global aerodynamic model of a campaign: collection of estimates, fit, slices and tables."""

"""An estimation from request to result: proposal, start values, computation, warnings, export."""

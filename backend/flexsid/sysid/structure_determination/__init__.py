"""Model structure determination: selection of the terms of a model."""

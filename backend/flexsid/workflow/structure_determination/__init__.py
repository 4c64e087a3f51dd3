"""Model structure determination: a search from request to ranked candidates."""

"""Maximum likelihood: output error, frequency response error, their noise and covariance."""

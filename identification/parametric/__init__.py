"""State-space models whose matrices depend on the operating point, from frequency responses, one estimator a file."""

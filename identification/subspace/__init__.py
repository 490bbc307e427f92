"""State-space models from frequency responses by subspace methods, one estimator a file, and what they share."""

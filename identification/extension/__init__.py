"""Models with physical effects in them, and the estimation of θ and effects together."""

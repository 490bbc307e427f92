"""Ways from data to a model with covariance: one file each, all reached through `identify`."""

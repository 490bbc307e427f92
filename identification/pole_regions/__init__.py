"""Regions of the complex plane in which the poles of a model must lie, one family a file."""

"""Estimators at one operating point, one a file."""

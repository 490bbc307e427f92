"""Estimators over the scheduling range, one a file."""

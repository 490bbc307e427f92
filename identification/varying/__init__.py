"""Estimators from records in which the scheduling varies, one a file, and what they stand on."""

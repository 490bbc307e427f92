"""The report of all that led to a model, and of where each version of it failed."""

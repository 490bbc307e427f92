"""Campaigns read from a folder, diagnosed and answered; see `benchmarks.cases.__main__`."""

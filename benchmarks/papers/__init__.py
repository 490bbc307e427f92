"""Every figure and table of the five papers beside ours; see `benchmarks.papers.__main__`."""

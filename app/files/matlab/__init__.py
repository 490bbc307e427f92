"""MATLAB files: level 5 and 7.3, to trees of variables, and from these to tables."""

"""Families of input spectra, one a file; each finds its best spectrum for given prices."""

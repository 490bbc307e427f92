"""Basis functions of one scheduling variable, one family a file."""

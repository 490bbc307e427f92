"""Tables in texts: encodings, decimal marks, separators, headers."""

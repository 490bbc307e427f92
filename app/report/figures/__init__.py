"""One plot a file, from objects of identification and oed; each comes with the table behind it."""

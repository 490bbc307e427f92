"""Documents to objects of identification and oed, and back."""

"""Physical effects that a model may lack, one a file."""

"""What a model becomes elsewhere."""

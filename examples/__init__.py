"""Plants of the literature, computed from their physics."""

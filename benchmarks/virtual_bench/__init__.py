"""A test bench whose plants hide effects; its integration and noise share nothing with the models of the project."""

"""Campaigns with something hidden in them, made by integrators that share nothing with the models; see `__main__`."""

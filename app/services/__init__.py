"""What the routers call: load, one call into the packages below or one job, save."""

"""What can be understood of measurements before a model is fitted to them."""

"""Which experiments to do next: models and accuracy targets in, operating points and input signals out."""

"""A simulated plant to learn and show the loop with: equations, integration and noise of its own."""

"""Where a physical effect can act in a plant, and what follows from the place alone: signature and simulation."""

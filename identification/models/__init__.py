"""What a model of a plant is: structures of one operating point, and a model over the scheduling variables."""

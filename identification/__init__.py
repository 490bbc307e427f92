"""What measurements say about a plant: data in, models with covariance out. No HTTP, no files, no clock."""

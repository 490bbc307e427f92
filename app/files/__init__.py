"""Files of measurements and signals: readers that trust nothing, and writers."""

"""Model against measurement: residuals of known distribution, where they are too large, and tests of that."""

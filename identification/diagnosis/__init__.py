"""Which missing physical effect the residuals point to, with the evidence for it."""

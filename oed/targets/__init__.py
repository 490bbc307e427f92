"""Accuracy targets, one a file; each becomes matrices R with P⁻¹ ⪰ R."""

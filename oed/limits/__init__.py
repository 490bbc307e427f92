"""What the plant may not do: limits of designed spectra, one a file; each is a price on what a spectrum uses of it."""

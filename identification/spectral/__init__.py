"""From time records to frequency responses with noise variance, one method a file."""

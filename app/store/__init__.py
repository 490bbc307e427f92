"""What is kept: rows in a database, arrays in content-addressed files."""

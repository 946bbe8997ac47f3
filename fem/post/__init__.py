"""What is read from a solved state: extremes, recovered stress, fields, self-intersection."""

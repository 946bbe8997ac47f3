"""Newton's method and the load path."""

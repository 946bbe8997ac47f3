"""Independent work on many points, in worker processes."""

"""Many designs, on workers of this machine or of a cluster."""

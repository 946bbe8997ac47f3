"""The arm's own law, measured on one cell and both ends."""

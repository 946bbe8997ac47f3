"""The arm's own law from one cell and two ends."""

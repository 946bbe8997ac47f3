"""The rod of a run: solved, exported, and the pressure for a wish."""

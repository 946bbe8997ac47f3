"""The law of an arm that bends in space."""

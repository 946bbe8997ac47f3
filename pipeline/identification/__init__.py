"""From simulated curves to the five parameters."""

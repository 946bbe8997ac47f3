"""What acts on the body besides its elasticity: loads, a strain-limiting layer, self-contact."""

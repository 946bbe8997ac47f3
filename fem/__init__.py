"""What the body does: hyperelastic finite elements under follower pressure and contact."""

"""What every effect of a configuration changes."""

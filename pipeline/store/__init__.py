"""The result directory."""

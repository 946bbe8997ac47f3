"""The story: from a config file to a report."""

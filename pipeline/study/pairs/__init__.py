"""Runs at pairs of pressures, and the law over both."""

"""The rod of a result folder: read from its files, and written for other rod codes."""

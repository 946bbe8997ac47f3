"""Body families: one module each, and bodies read from files."""

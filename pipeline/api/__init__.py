"""One function for each thing that pneurod does: the command line runs them, and `pneurod` has them for Python."""

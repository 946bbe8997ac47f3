"""The rod for other codes."""

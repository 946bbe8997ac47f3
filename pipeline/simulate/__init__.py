"""The experiments in finite elements, and what is unusual about a design or its mesh."""

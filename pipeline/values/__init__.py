"""Values that every other folder uses: they import nothing of this package but each other."""

"""Many designs from one file: their points, the work on each of them, the workers, the table and the picture."""

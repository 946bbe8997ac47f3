"""The report of a run: tables, figures, pictures, and progress on the terminal."""

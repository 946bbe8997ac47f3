"""What a user should know of a run: rules that give `geometry.Reason` values, and the table that makes sentences."""

from pipeline.notes.templates import record_reason, render, render_all

__all__ = ["record_reason", "render", "render_all"]

"""What a user should know of a run: rules that give `geometry.Reason` values, and the table that makes sentences."""

from pipeline.notes.templates import render, render_all, report_reason

__all__ = ["render", "render_all", "report_reason"]

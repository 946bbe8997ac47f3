"""An arm that was built and measured, beside its rod."""

"""An arm that was built and measured: compared with its rod, and the rod calibrated to it."""

"""What a run does at the same time: tasks in worker processes."""

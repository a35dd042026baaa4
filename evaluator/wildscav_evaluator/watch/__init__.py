"""What looks on while an evaluation runs: dashboard, log and metrics."""

"""How a running evaluation is watched: dashboard, log and metrics."""

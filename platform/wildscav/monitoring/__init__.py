"""How servers and evaluations report on themselves: structured log lines and Prometheus metrics."""

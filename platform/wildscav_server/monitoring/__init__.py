"""Monitoring of servers and evaluations: structured log lines and Prometheus metrics."""

"""Monitoring of a running evaluation: dashboard, log and metrics."""

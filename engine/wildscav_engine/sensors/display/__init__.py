"""Sensor readings as images for people."""

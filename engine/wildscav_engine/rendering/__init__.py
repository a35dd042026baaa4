"""Images of the world: what every ray of a camera meets."""

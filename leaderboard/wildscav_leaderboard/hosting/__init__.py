"""Running a season: the web server, the conductor, and both together."""

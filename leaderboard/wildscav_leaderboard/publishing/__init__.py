"""What is published of a season, so that anyone can audit it: at the web site, and as a folder of files."""

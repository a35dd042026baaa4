"""What an environment looks like: pictures, and a live view."""

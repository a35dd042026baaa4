"""What runs on a Ray cluster, and the process that talks to it."""

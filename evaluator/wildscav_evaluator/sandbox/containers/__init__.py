"""The sandbox of containers, run by Docker or Podman."""

"""The sandbox that runs agents in containers of Docker or Podman."""

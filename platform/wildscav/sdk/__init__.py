"""The agent SDK: it runs an agent's code and connects it to a match server."""

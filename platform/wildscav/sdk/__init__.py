"""The agent SDK: what an agent senses and does, and the connection that carries it."""

"""The versions of the engine and of what it simulates."""

from importlib.metadata import version

ENGINE_VERSION = version("wildscav")

# Rises whenever the same spec and actions give another match: a record can be played again by its own only.
SIMULATION_VERSION = 5

"""The match protocol: ``match.proto`` and the Python code that ``make proto`` generates from it."""

PROTOCOL_VERSION = 1

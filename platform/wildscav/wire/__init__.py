"""Encoding and decoding of protocol messages: one place for each message and direction.

Nothing here imports the engine. The server passes plain values, and observations as bytes that its own kernel
has written; the SDK gets its classes.
"""

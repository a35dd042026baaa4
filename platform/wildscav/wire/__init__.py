"""Between protocol messages and plain Python and NumPy: one place for each message and direction.

Nothing here knows the engine: the server hands over plain values, and what seats sense as bytes that a kernel
of its own wrote; the SDK gets its classes.
"""

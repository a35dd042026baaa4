"""Between protocol messages and plain Python and NumPy: one place for each message and direction.

Nothing here knows the engine: the server hands over plain numbers and bytes, the SDK gets its classes.
"""

"""Between protocol messages and plain Python and NumPy: one place for each message and direction.

Nothing here knows the engine: the server hands over plain lists (``Snapshot``), the SDK gets its dataclasses.
"""

"""The original game's client plays here: a drop-in for its engine, over the original's own wire contract.

The roles are the reverse of ours: the client is the server, and the engine calls it (``commander.proto``).
All rules are the engine's; what stands here translates.
"""

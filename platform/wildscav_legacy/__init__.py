"""A replacement for the original game's engine: the original's client plays here, over its own protocol.

The roles are the reverse of ours: the client is the gRPC server, and the engine calls it
(``commander.proto``). All rules are those of our engine; this package only translates.
"""

"""The server's side of HTTP/2, as far as gRPC needs it, with limits on everything that a client can consume.

gRPC's own server reads the connections of a process in threads that they all share. It does not limit or
report frames without messages, or short-lived connections. So a single client could take the time of all
others. Here all connections are read in the event loop, and each has an allowance of frames. Clients that
have not identified themselves share a small part of the time, and a client that exceeds its limits is
reported.
"""

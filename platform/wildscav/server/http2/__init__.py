"""The server's side of HTTP/2, as far as gRPC needs it, with a limit on everything that a client may cost.

gRPC's own server reads the connections of a process in threads that all of them share. It limits neither the
frames that carry no message nor the connections that come and go, and it does not report them. So a single
client could take the time of all others. Here all connections are read in the event loop, and each has an
allowance. Clients that have not said who they are share a small part of the time, and a client that goes too
far is named.
"""

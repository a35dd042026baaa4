"""The server's side of HTTP/2, as far as gRPC needs it, with limits on everything that a client can consume.

gRPC's own server limits some of this, such as pings. But it reads all connections of a process in threads
that they share, so nobody can tell which client took how much of their time, and charge its seat. Here all
connections are read in the event loop, and each has an account. Clients that have not identified themselves
share a small part of the time, and a client that exceeds its limits is reported.
``benchmarks/results/services.md`` says what the alternatives cost.
"""

"""A server with several processes: a dispatcher for organizers, and supervised workers that play matches."""

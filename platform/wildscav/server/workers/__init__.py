"""A server of several processes: a dispatcher for organizers, and supervised workers that play matches."""

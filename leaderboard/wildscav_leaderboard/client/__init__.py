"""A client of a season's API: what the commands of competitors do on the other side of the network."""

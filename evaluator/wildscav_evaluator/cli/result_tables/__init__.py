"""Tables of results, narrow enough for a terminal of 80 columns."""

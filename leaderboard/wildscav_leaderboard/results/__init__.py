"""The database of local results: what `wildscav evaluate` and `tournament` store, and the standings in it."""

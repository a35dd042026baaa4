"""The ledger of an evaluation: a hash chain of its events, signed if its organizer has a key."""

"""The ledger of an evaluation: all that happened in it, chained, and signed if its organizer has a key."""

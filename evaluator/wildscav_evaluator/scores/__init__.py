"""Scores: what matches say of a submission, computed anew from records, and compared."""

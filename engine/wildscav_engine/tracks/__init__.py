"""The kinds of match: one file and one registry line a track."""

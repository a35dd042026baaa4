"""The limits on an evaluation's size. Light to import, because commands show them in their help."""

MOST_ROUNDS = 1000  # of a suite, each with the next seed
MOST_MATCHES = 20_000  # on a track, in all rounds: drawing one takes a moment
MOST_EVALUATIONS = 10_000  # in one results file: each is one submission on one track

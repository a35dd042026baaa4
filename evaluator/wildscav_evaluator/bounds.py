"""The limits on an evaluation's size. Light to import, because commands show them in their help."""

MOST_ROUNDS = 1000  # of a suite, each with the next seed
MOST_MATCHES = 20_000  # on a track, in all rounds: drawing one takes a moment
MOST_EVALUATIONS = 10_000  # in one results file: each is one submission on one track
FEWEST_ENTRANTS = 2  # of a tournament
MOST_ENTRANTS = 1000
MOST_PLAYERS = 50_000  # of all matches of a tournament together: each takes a kilobyte of the results

"""The limits on an evaluation's size. Light to import, because commands show them in their help."""

MAX_ROUNDS = 1000  # of a suite, each with the next seed
MAX_MATCHES = 20_000  # on a track, in all rounds: drawing one takes a moment
MAX_EVALUATIONS = 10_000  # in one results file: each is one submission on one track
FEWEST_ENTRANTS = 2  # of a tournament
MAX_ENTRANTS = 1000
MAX_PLAYERS = 50_000  # of all matches of a tournament together: each takes a kilobyte of the results

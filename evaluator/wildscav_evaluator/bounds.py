"""How large an evaluation may be. Light to import, so that commands can show it in their help."""

MOST_ROUNDS = 1000  # of a suite, each with the next seed
MOST_MATCHES = 20_000  # on a track, in all rounds: each takes a moment to draw
MOST_EVALUATIONS = 10_000  # in one results file: of one submission on one track each

"""Rate matches of any game: all at once with intervals, and one after the other on a ladder."""

from wildscav_evaluator.ratings.bands import rank_entrants
from wildscav_evaluator.ratings.fit import fit
from wildscav_evaluator.ratings.ladder import Ladder
from wildscav_evaluator.ratings.matches import RatedMatch

matches = [
    RatedMatch(game=game, teams=(("ada",), ("bob",), ("cy",)), places=places)
    for game, places in enumerate([(1, 2, 3), (1, 3, 2), (1, 2, 2), (2, 1, 3)] * 4)
]

fitted = fit(matches)  # all matches at once, in any order
ranking = rank_entrants(fitted)
for name, rating in zip(fitted.names, fitted.ratings, strict=True):
    print(name, round(rating), ranking.ranks[name])
print(ranking.bands)

ladder = Ladder()  # one match after the other
for match in matches:
    ladder.apply(match)
skill = ladder.skills["ada"]
print(round(skill.rating), round(skill.deviation))

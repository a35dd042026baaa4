"""Who won: the result of an episode between the learners and each other seat."""

from collections.abc import Iterator

from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
from wildscav_engine.tracks import TRACKS

WIN, DRAW, LOSS = 1.0, 0.5, 0.0


def results_against(match: MatchInBatch, learners: int, seat: int) -> Iterator[float]:
    """Yield the results of an episode against one seat: one for each team of learners except the seat's own.

    The score decides, which is the first metric of the track; in ``royale``, the points, and so mainly the
    placement. The first learner of each team counts.

    Args:
        match: The match at the end of the episode.
        learners: The number of learners, who have the first seats.
        seat: The seat that the learners played against.
    """
    teams = match.spec.team_of_seats
    first_of_team = {teams[learner]: learner for learner in reversed(range(learners))}
    for team in sorted(first_of_team.keys() - {teams[seat]}):
        yield _compare(_score(match, first_of_team[team]), _score(match, seat))


def _score(match: MatchInBatch, seat: int) -> float:
    """Return the score of a seat; more is better."""
    track = TRACKS[match.spec.track]
    metric = track.metrics[0]
    score = track.measure(match, seat)[metric.name]
    return -score if metric.lower_is_better else score


def _compare(own: float, other: float) -> float:
    if own == other:
        return DRAW
    return WIN if own > other else LOSS

"""The outcome of a match in one sentence: who won, and with what score."""

from collections.abc import Sequence
from typing import NamedTuple

from wildscav_engine.specs.result import MatchResult
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.tracks import TRACKS, Metric


class Team(NamedTuple):
    """The result of one team."""

    name: str
    score: float
    metrics: dict[str, float]  # of its best seat


def format_time(frame: int) -> str:
    """Return the game time of a frame as minutes and seconds."""
    minutes, seconds = divmod(frame // FRAMES_PER_SECOND, 60)
    return f"{minutes}:{seconds:02d}"


def describe_outcome(result: MatchResult, names: Sequence[str]) -> str:
    """Return a sentence without a full stop that says who won and with what score."""
    metric = TRACKS[result.track].metrics[0]
    teams = _ranked(result, names, metric)
    if TRACKS[result.track].has_target and "success" in teams[0].metrics:
        return _target_outcome(result, teams)
    best = [team for team in teams if team.score == teams[0].score]
    score = _written(teams[0].score, metric)
    if len(teams) == 1:
        return f"{teams[0].name} ends with {score}"
    if len(best) > 1:
        return f"{_listed([team.name for team in best])} tie at {score}"
    ahead = f"ahead of {teams[1].name} with {_written(teams[1].score, metric)}"
    return f"{best[0].name} wins with {score}, {ahead}"


def _target_outcome(result: MatchResult, teams: list[Team]) -> str:
    """Describe who reached the target; if nobody did, who was nearest."""
    arrived = [team.name for team in teams if team.metrics["success"] > 0]
    time = f"{result.frames / FRAMES_PER_SECOND:.1f} s"
    if arrived:
        return f"{_listed(arrived)} reached the target after {time}"
    score = f"{teams[0].score:.1f} s with the punish time"
    if len(teams) == 1:
        return f"{teams[0].name} did not reach the target: {score}"
    return f"Nobody reached the target; {teams[0].name} was nearest: {score}"


def _ranked(result: MatchResult, names: Sequence[str], metric: Metric) -> list[Team]:
    """Return the teams, best first."""
    members: dict[int, list[int]] = {}
    for seat in result.seats:
        members.setdefault(seat.team, []).append(seat.seat)
    sign = 1 if metric.lower_is_better else -1
    teams = []
    for team, seats in members.items():
        best = min((result.seats[seat].metrics for seat in seats), key=lambda each: sign * each[metric.name])
        name = names[seats[0]] if len(seats) == 1 else f"Team {team + 1}"
        if len(members) == 1 and len(seats) > 1:
            name = "The team"
        teams.append(Team(name, best[metric.name], best))
    return sorted(teams, key=lambda team: sign * team.score)


def _written(score: float, metric: Metric) -> str:
    number = f"{score:.0f}" if score == round(score) else f"{score:.1f}"
    return f"{number} {metric.title}" if not metric.unit else f"{number} {metric.unit}"


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"

"""The places of a tournament's teams, from the results of its matches."""

import math
from collections.abc import Iterator, Sequence

from wildscav_evaluator.output.results import Evaluation, MetricInfo, Results, SeatRow
from wildscav_evaluator.ratings.matches import RatedMatch

PLACEMENT = "placement"  # the metric of tracks that place teams themselves


def placing_metric(metrics: Sequence[MetricInfo]) -> MetricInfo:
    """Return the metric by which the teams of a match are placed: ``placement``, else the score."""
    return next((metric for metric in metrics if metric.name == PLACEMENT), metrics[0])


def rated_matches(results: Results, repeats: int) -> Iterator[RatedMatch]:
    """Yield the matches of a tournament that have a result, in the order of its schedule.

    Each game was played ``repeats`` times, in consecutive matches.
    """
    metric = placing_metric(results.evaluations[0].metrics)
    for index, seats in sorted(_seats_by_match(results.evaluations).items()):
        teams = _teams(seats)
        values = [_value(team, metric) for team in teams]
        yield RatedMatch(
            game=index // repeats,
            teams=tuple(tuple(dict.fromkeys(str(seat.submission) for seat in team)) for team in teams),
            places=tuple(1 + sum(other < value for other in values) for value in values),
        )


def _seats_by_match(evaluations: Sequence[Evaluation]) -> dict[int, list[SeatRow]]:
    seats: dict[int, list[SeatRow]] = {}
    for evaluation in evaluations:
        for row in evaluation.matches:
            if row.metrics is not None:
                seats.setdefault(row.index, []).extend(row.seats)
    return seats


def _teams(seats: Sequence[SeatRow]) -> list[list[SeatRow]]:
    """Return the seats of each team, in the order of their numbers."""
    teams: dict[int | None, list[SeatRow]] = {}
    for seat in sorted(seats, key=lambda one: one.seat):
        teams.setdefault(seat.team, []).append(seat)
    return list(teams.values())


def _value(team: Sequence[SeatRow], metric: MetricInfo) -> float:
    """Return the value by which a team is placed; less is better."""
    mean = math.fsum(seat.metrics[metric.name] for seat in team) / len(team)
    return mean if metric.lower_is_better else -mean

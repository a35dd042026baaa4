"""The board of a ladder: submissions and robots meet each other, and are rated by their places.

The ratings are applied in the order in which the matches were made, up to the first one that is not over
yet. So the history never moves, whatever order the matches end in; a match that was given up counts for
nobody.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np

from wildscav_evaluator.output.results import MetricInfo
from wildscav_evaluator.ratings.ladder import Skill
from wildscav_leaderboard.boards.documents import LadderBoard, LadderRow
from wildscav_leaderboard.boards.ranks import better_by_rating, rank_ranges
from wildscav_leaderboard.seasons.editions import Conditions

WIDTH = 1.959964  # standard deviations, of a 95 % interval
DECIMALS = 2  # of ratings on a board


@dataclass(frozen=True)
class LadderResults:
    """What is known of an entrant of a ladder."""

    submission: int | None  # None for a robot
    name: str
    version: str
    team: str  # empty for a robot
    team_title: str
    since: datetime | None
    planned: int  # matches until its rating counts as settled
    faults: int
    skill: Skill
    places: tuple[int, ...]  # in the matches that were applied
    wins: int


def ladder_board(
    track: str,
    conditions: Conditions,
    metrics: tuple[MetricInfo, ...],
    results: Sequence[LadderResults],
    applied: int,
    updated: datetime,
) -> LadderBoard:
    """Return the board that follows from the skills of all entrants.

    A team stands on it with its submission of the highest rating.

    Args:
        track: The track.
        conditions: Under which the matches were played.
        metrics: Of the track.
        results: Of the entrants.
        applied: The matches that the skills come from.
        updated: When the last result arrived.
    """
    ordered = sorted(results, key=lambda one: (not one.places, -one.skill.mu, one.submission or 0, one.name))
    first: dict[str, LadderResults] = {}
    for one in ordered:
        first.setdefault(one.team or f"robot:{one.name}", one)
    shown = list(first.values())
    ranked = [one for one in shown if one.places]
    means = np.array([one.skill.mu for one in ranked])
    deviations = np.array([one.skill.sigma for one in ranked])
    ranges = rank_ranges(better_by_rating(means, deviations)) if ranked else []
    rows = [_row(one, *ranks) for one, ranks in zip(ranked, ranges, strict=True)]
    rows += [_row(one, None, None) for one in shown if not one.places]
    return LadderBoard(
        track=track,
        conditions=conditions,
        updated=updated,
        applied=applied,
        metrics=metrics,
        entered=tuple(sorted(one.submission for one in results if one.submission is not None)),
        rows=tuple(rows),
    )


def _row(one: LadderResults, rank: int | None, last_rank: int | None) -> LadderRow:
    rating, deviation = one.skill.rating, one.skill.deviation
    places = one.places
    return LadderRow(
        rank=rank,
        last_rank=last_rank,
        team=one.team,
        team_title=one.team_title,
        submission=one.submission,
        name=one.name,
        version=one.version,
        matches=len(places),
        planned=max(one.planned, len(places)),
        faults=one.faults,
        since=one.since,
        rating=round(rating, DECIMALS),
        deviation=round(deviation, DECIMALS),
        low=round(rating - WIDTH * deviation, DECIMALS),
        high=round(rating + WIDTH * deviation, DECIMALS),
        wins=one.wins,
        mean_place=round(sum(places) / len(places), DECIMALS) if places else None,
        mu=one.skill.mu,
        sigma=one.skill.sigma,
    )

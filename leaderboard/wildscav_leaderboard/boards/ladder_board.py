"""The board of a ladder: submissions and robots meet each other, and are rated by their places.

Ratings are fitted to all matches at once, up to the first one that is not over yet. So neither the order of
the matches nor that of their ends changes a rating; a match that was given up counts for nobody.

A rating is provisional until its interval is as narrow as the season asks. Until then its row stands where
the lower end of the interval is, so that luck in a few matches leads nobody to the top.
"""

from collections.abc import Sequence
from datetime import datetime
from typing import NamedTuple

import numpy as np

from wildscav_evaluator.output.results import MetricInfo
from wildscav_evaluator.ratings.bands import FEWEST_GAMES, significantly_better
from wildscav_evaluator.ratings.fit import AVERAGE, DECIMALS
from wildscav_evaluator.ratings.head_to_head import EntrantRecord, entrant_records
from wildscav_evaluator.resampling import CONFIDENCE, student_quantile
from wildscav_leaderboard.boards.documents import Entry, LadderBoard, LadderRow
from wildscav_leaderboard.boards.ladders import Played
from wildscav_leaderboard.boards.ranks import rank_ranges
from wildscav_leaderboard.seasons.editions import Conditions

PLACE_DECIMALS = 2  # of mean places on a board


class Enough(NamedTuple):
    """When an entrant has played enough."""

    interval: float  # width of the 95 % interval of its rating, in points of Elo
    matches: int  # it plays no more than these, even if its interval is wider


class Rating(NamedTuple):
    """An entrant's rating on the scale of Elo."""

    mean: float = AVERAGE
    deviation: float = 0.0
    low: float = AVERAGE  # of the 95 % interval
    high: float = AVERAGE
    is_settled: bool = False  # whether its interval is as narrow as the season asks

    @property
    def counts(self) -> float:
        """What its row is ordered by."""
        return self.mean if self.is_settled else self.low


def ratings_of(played: Played, interval: float) -> dict[str, Rating]:
    """Return the rating of everyone who played, by name.

    Args:
        interval: The width at which a rating is settled.
    """
    if not played.matches:
        return {}
    found = played.fit
    widths = found.deviations * student_quantile(np.maximum(found.games, 2), 1.0 - CONFIDENCE)
    settled = (found.games >= FEWEST_GAMES) & (2.0 * widths <= interval)
    values = (found.ratings, found.deviations, found.ratings - widths, found.ratings + widths)
    columns = [np.round(one, DECIMALS).tolist() for one in values]
    rows = zip(*columns, settled.tolist(), strict=True)
    return {name: Rating(*row) for name, row in zip(found.names, rows, strict=True)}


def ladder_board(
    track: str,
    conditions: Conditions,
    metrics: tuple[MetricInfo, ...],
    entrants: Sequence[Entry],
    played: Played,
    enough: Enough,
    updated: datetime,
) -> LadderBoard:
    """Return the board that follows from the matches of a ladder.

    A team stands on it with its best submission. Ranks allow for the choice: all submissions are compared.

    Args:
        conditions: Under which the matches were played.
        enough: When an entrant has played enough.
    """
    ratings, records = ratings_of(played, enough.interval), entrant_records(played.matches)
    unrated = Rating()

    def key(one: Entry) -> tuple[bool, float, int, str]:
        rating = ratings.get(one.entrant, unrated)
        return one.entrant not in records, -rating.counts, one.submission or 0, one.name

    first: dict[str, Entry] = {}
    for one in sorted(entrants, key=key):
        first.setdefault(one.team or f"robot:{one.name}", one)
    names = [one.entrant for one in entrants if one.entrant in records]
    ranks = _ranks(played, names, [one.entrant for one in first.values() if one.entrant in records])
    rows = [
        _row(
            one,
            ratings.get(one.entrant, unrated),
            records.get(one.entrant),
            played.faults.get(one.entrant, 0),
            ranks.get(one.entrant, (None, None)),
            enough.matches,
        )
        for one in first.values()
    ]
    return LadderBoard(
        track=track,
        conditions=conditions,
        updated=updated,
        applied=len(played.matches),
        metrics=metrics,
        entered=tuple(sorted(one.submission for one in entrants if one.submission is not None)),
        rows=tuple(rows),
    )


def _ranks(played: Played, names: Sequence[str], shown: Sequence[str]) -> dict[str, tuple[int, int]]:
    """Return the best and the worst rank of those that are shown, of all names that are compared."""
    if not shown:
        return {}
    compared = played.fit.among(names)
    better = significantly_better(compared)
    rows = [compared.names.index(name) for name in shown]
    return dict(zip(shown, rank_ranges(better[np.ix_(rows, rows)]), strict=True))


def _row(
    one: Entry,
    rating: Rating,
    record: EntrantRecord | None,
    faults: int,
    ranks: tuple[int, int] | tuple[None, None],
    most: int,
) -> LadderRow:
    matches = 0 if record is None else record.matches
    return LadderRow(
        rank=ranks[0],
        last_rank=ranks[1],
        **one.shown,
        matches=matches,
        planned=matches if rating.is_settled else max(most, matches),
        faults=faults,
        provisional=not rating.is_settled,
        rating=rating.mean,
        deviation=rating.deviation,
        low=rating.low,
        high=rating.high,
        wins=0 if record is None else record.wins,
        mean_place=None if record is None else round(record.mean_place, PLACE_DECIMALS),
    )

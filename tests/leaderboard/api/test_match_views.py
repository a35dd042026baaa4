"""Who is said to have won a match: whoever its ladder places first."""

from datetime import UTC, datetime

import pytest

from wildscav_leaderboard.api.documents import SeatView
from wildscav_leaderboard.api.match_views import judged
from wildscav_leaderboard.matches.models import LADDER, SUITE, Match

NOW = datetime(2030, 1, 1, tzinfo=UTC)
TEAMS = ("Owls", "Foxes", "Newts")


def seats_with(metric: str, values: tuple[float | None, ...]) -> list[SeatView]:
    """Return a seat of each team; that of the last value has a robot."""
    return [
        SeatView(
            seat=seat,
            entrant=name,
            name="fighter" if seat == len(values) - 1 else f"agent {seat}",
            submission=None,
            team=None,
            team_title=None if seat == len(values) - 1 else name,
            metrics=None if value is None else {metric: value},
        )
        for seat, (name, value) in enumerate(zip(TEAMS, values, strict=False))
    ]


@pytest.mark.parametrize(
    ("kind", "track", "metric", "values", "winner", "places"),
    [
        (LADDER, "battle", "supplies", (3.0, 7.0, 5.0), "Foxes", [3, 1, 2]),
        (LADDER, "battle", "supplies", (3.0, 4.0), "fighter", [2, 1]),  # a robot wins by its name
        (LADDER, "navigation", "time", (12.0, 30.0), "Owls", [1, 2]),  # the shorter time
        (LADDER, "royale", "placement", (2.0, 3.0, 1.0), "fighter", [2, 3, 1]),  # not by its score
        (LADDER, "battle", "supplies", (7.0, 7.0, 5.0), "Owls and Foxes, tied", [1, 1, 3]),
        (LADDER, "battle", "supplies", (0.0, 0.0), "no winner: a tie", [1, 1]),
        (LADDER, "battle", "supplies", (3.0, None), None, [None, None]),  # only the own seat is seen
        (LADDER, "battle", "supplies", (None, None), None, [None, None]),  # hidden, or not over
        (SUITE, "navigation", "time", (12.0,), "no winner: played for the score", [None]),
        (SUITE, "battle", "supplies", (None,), None, [None]),
    ],
)
def test_the_winner(
    kind: str,
    track: str,
    metric: str,
    values: tuple[float | None, ...],
    winner: str | None,
    places: list[int | None],
) -> None:
    match = Match(kind=kind, track=track, number=0, group_id=0, spec={}, created=NOW, since=NOW)

    seats, named = judged(match, seats_with(metric, values))

    assert named == winner
    assert [seat.place for seat in seats] == places

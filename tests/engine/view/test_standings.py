"""The table of standings, and the outcome in one sentence."""

import pytest
from tests.builders import make_match

from wildscav_engine.maps import GameMap
from wildscav_engine.record import Record, record_of, resimulate
from wildscav_engine.specs.result import MatchResult, SeatResult
from wildscav_engine.view.outcome import describe_outcome, format_time
from wildscav_engine.view.recording.history import collect_history
from wildscav_engine.view.standings import MAX_LINES, moving_standings


def result(track: str, *seats: tuple[int, dict[str, float]], frames: int = 2000) -> MatchResult:
    """The end of a match: the team and the metrics of each seat."""
    nothing = {"supplies": 0, "kills": 0, "deaths": 0, "shots": 0, "hits": 0, "walked": 0.0}
    return MatchResult(
        track=track,
        frames=frames,
        steps=frames // 5,
        seats=tuple(
            SeatResult(seat=seat, filled_by="walker", team=team, metrics=metrics, **nothing)
            for seat, (team, metrics) in enumerate(seats)
        ),
    )


def supplies(number: float) -> dict[str, float]:
    return {"supplies": number, "kills": 0.0, "deaths": 0.0}


def time(seconds: float, success: float) -> dict[str, float]:
    return {"time": seconds, "used_time": 40.0, "punish_time": seconds - 40.0, "success": success}


@pytest.mark.parametrize(
    ("ended", "told"),
    [
        (
            result("battle", (0, supplies(3)), (1, supplies(8)), (2, supplies(5))),
            "bob wins with 8 supplies, ahead of eve with 5 supplies",
        ),
        (result("battle", (0, supplies(8)), (1, supplies(8))), "ann and bob tie at 8 supplies"),
        (
            result("battle", (0, supplies(3)), (1, supplies(8)), (0, supplies(3))),
            "bob wins with 8 supplies, ahead of Team 1 with 3 supplies",
        ),
        (result("gathering", (0, supplies(7))), "ann ends with 7 supplies"),
        (result("gathering", (0, supplies(7)), (0, supplies(7))), "The team ends with 7 supplies"),
        (result("navigation", (0, time(40.0, 1.0))), "ann reached the target after 40.0 s"),
        (
            result("navigation", (0, time(52.5, 0.0))),
            "ann did not reach the target: 52.5 s with the punish time",
        ),
        (
            result("navigation", (0, time(52.5, 0.0)), (1, time(44.0, 0.0))),
            "Nobody reached the target; bob was nearest: 44.0 s with the punish time",
        ),
        (
            result("capture", (0, time(40.0, 1.0)), (0, time(40.0, 1.0))),
            "The team reached the target after 40.0 s",
        ),
        (
            result("royale", (0, {"points": 35.5}), (1, {"points": 195.0})),
            "bob wins with 195 points, ahead of ann with 35.5 points",
        ),
    ],
)
def test_the_outcome_says_who_won_and_with_what(ended: MatchResult, told: str) -> None:
    assert describe_outcome(ended, ("ann", "bob", "eve")) == told


def test_a_clock_shows_minutes_and_seconds() -> None:
    assert [format_time(frame) for frame in (0, 49, 50, 3000, 30_050)] == [
        "0:00",
        "0:00",
        "0:01",
        "1:00",
        "10:01",
    ]


def pages(record: Record, followed: int = 0, game_map: GameMap | None = None) -> list[str]:
    _, history = collect_history(resimulate(record, game_map), record.steps, None)
    columns = moving_standings(record, history, record.names, followed)
    (component,) = columns.values
    return [str(text[0]) for text in component.as_arrow_array().to_pylist()]


def test_the_leader_comes_first_and_the_end_tells_the_outcome(battle: Record) -> None:
    every = pages(battle)
    best = max(battle.result.seats, key=lambda seat: seat.supplies)
    first = next(line for line in every[-1].splitlines() if line.startswith("| 1 |"))

    assert f" {best.supplies} |" in first
    assert "**0:00 of 0:10**" in every[0]
    assert "wins" in every[-1] or "tie" in every[-1]
    assert not any("wins" in page for page in every[:-1])


def test_names_are_text_and_no_markdown() -> None:
    match = make_match("battle", seats=2, time_limit=0.2)
    match.play_out()
    record = record_of(match, ["![x](http://example.com/a.png) | 9", "<b>eve</b>\n# won"])

    page = pages(record, game_map=match.game_map)[-1]

    assert "\\!\\[x\\]\\(http\\://example\\.com/a\\.png\\) \\| 9" in page
    assert "\\<b\\>eve\\</b\\> \\# won" in page


def test_of_many_agents_the_best_and_the_followed_one_are_shown() -> None:
    match = make_match("battle", seats=MAX_LINES + 8, time_limit=0.2)
    match.play_out()
    record = record_of(match, [f"agent{seat:02d}" for seat in range(MAX_LINES + 8)])

    page = pages(record, followed=MAX_LINES + 5, game_map=match.game_map)[-1]

    assert page.count("agent") == MAX_LINES + page.splitlines()[2].count("agent")
    assert f"**agent{MAX_LINES + 5}**" in page
    assert page.endswith("and 8 more")

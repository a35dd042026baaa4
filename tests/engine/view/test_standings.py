"""The table of standings, and the outcome in one sentence."""

import pytest
from tests.builders import make_match

from wildscav_engine.maps import GameMap
from wildscav_engine.record import Record, record_of, resimulate
from wildscav_engine.specs.result import MatchResult, SeatResult
from wildscav_engine.view.outcome import describe_outcome, format_time
from wildscav_engine.view.recording.history import collect_history
from wildscav_engine.view.standings import MAX_LINES, moving_standings


def result(track: str, seats: list[tuple[int, float]]) -> MatchResult:
    """The end of a match after 40 s: each seat has a team and a score, or the time to its target."""
    nothing = {"supplies": 0, "kills": 0, "deaths": 0, "shots": 0, "hits": 0, "walked": 0.0}

    def metrics(score: float) -> dict[str, float]:
        time = {"time": score, "used_time": 40.0, "punish_time": score - 40.0, "success": score == 40.0}
        told = "points" if track == "royale" else "supplies"
        return time if track in {"navigation", "capture"} else {"supplies": 1.0, "points": 1.0, told: score}

    ended = tuple(
        SeatResult(seat=seat, filled_by="walker", team=team, metrics=metrics(score), **nothing)
        for seat, (team, score) in enumerate(seats)
    )
    return MatchResult(track=track, frames=2000, steps=400, seats=ended)


@pytest.mark.parametrize(
    ("track", "seats", "told"),
    [
        ("battle", [(0, 3), (1, 8), (2, 5)], "bob wins with 8 supplies, ahead of eve with 5 supplies"),
        ("battle", [(0, 8), (1, 8)], "ann and bob tie at 8 supplies"),
        ("battle", [(0, 3), (1, 8), (0, 3)], "bob wins with 8 supplies, ahead of Team 1 with 3 supplies"),
        ("gathering", [(0, 7)], "ann ends with 7 supplies"),
        ("gathering", [(0, 7), (0, 7)], "The team ends with 7 supplies"),
        ("navigation", [(0, 40.0)], "ann reached the target after 40.0 s"),
        ("navigation", [(0, 52.5)], "ann did not reach the target: 52.5 s with the punish time"),
        (
            "navigation",
            [(0, 52.5), (1, 44.0)],
            "Nobody reached the target; bob was nearest: 44.0 s with the punish time",
        ),
        ("capture", [(0, 40.0), (0, 40.0)], "The team reached the target after 40.0 s"),
        ("royale", [(0, 35.5), (1, 195.0)], "bob wins with 195 points, ahead of ann with 35.5 points"),
    ],
)
def test_the_outcome_says_who_won_and_with_what(
    track: str, seats: list[tuple[int, float]], told: str
) -> None:
    assert describe_outcome(result(track, seats), ("ann", "bob", "eve")) == told


def test_a_clock_shows_minutes_and_seconds() -> None:
    times = {0: "0:00", 49: "0:00", 50: "0:01", 3000: "1:00", 30_050: "10:01"}
    assert {frame: format_time(frame) for frame in times} == times


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

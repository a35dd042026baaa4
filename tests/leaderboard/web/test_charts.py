"""Charts of ranks: where the lines are; and parts of pages that are kept."""

from datetime import datetime, timedelta
from itertools import pairwise

import pytest
from markupsafe import Markup
from tests.leaderboard.seasons_made import NOON

from wildscav_leaderboard.boards.models import BoardPoint
from wildscav_leaderboard.web.charts import LEFT, MAX_POINTS, NEAREST, Chart, rank_chart
from wildscav_leaderboard.web.rendering import PageParts

HOUR = timedelta(hours=1)
END = NOON + 10 * HOUR


def point(hours: float, rank: int, last_rank: int | None = None) -> BoardPoint:
    found = {"rank": rank, "last_rank": last_rank or rank, "matches": 3}
    found |= {"score": 1.0, "low": 0.0, "high": 2.0}
    return BoardPoint(track="battle", submission_id=1, at=NOON + hours * HOUR, **found)


def drawn(
    histories: list[tuple[str, list[BoardPoint]]], until: datetime = END, *, bands: bool = False
) -> Chart:
    chart = rank_chart(histories, until, bands=bands)
    assert chart is not None
    return chart


def corners(path: str) -> list[tuple[float, float]]:
    pairs = (corner.split(",") for corner in path.removeprefix("M").removesuffix("Z").split())
    return [(float(x), float(y)) for x, y in pairs]


def test_a_line_keeps_each_rank_until_the_next_one_and_goes_on_to_the_end() -> None:
    chart = drawn([("owls", [point(0, 2), point(5, 1)])], bands=True)
    (line,) = chart.lines
    y = {rank: at for at, rank in chart.ranks}
    half = (LEFT + chart.right) / 2

    assert corners(line.path) == [(LEFT, y[2]), (half, y[2]), (half, y[1]), (chart.right, y[1])]
    assert y[1] < y[2], "the first is at the top"
    assert line.end == (chart.right, y[1])


def test_who_could_not_be_told_apart_has_a_band_around_the_middle() -> None:
    chart = drawn([("owls", [point(0, 1, 3), point(5, 2)])], bands=True)
    y = {rank: at for at, rank in chart.ranks}
    heights = {height for _, height in corners(chart.lines[0].band)}

    assert corners(chart.lines[0].path)[0] == (LEFT, y[2])
    assert min(heights) < y[1]
    assert max(heights) > y[3]


def test_labels_do_not_cover_each_other_where_ranks_are_shared() -> None:
    teams = [(f"team {number}", [point(0, 1, 6), point(1, 1, 6)]) for number in range(6)]
    ys = sorted(line.label_y for line in drawn(teams).lines)

    assert min(after - before for before, after in pairwise(ys)) >= NEAREST


@pytest.mark.parametrize(
    ("points", "until"),
    # Nobody was ranked, one point is no line, and all of it came later.
    [([], END), ([point(0, 1)], END), ([point(0, 1), point(1, 1)], NOON)],
)
def test_without_a_course_there_is_no_chart(points: list[BoardPoint], until: datetime) -> None:
    assert rank_chart([("owls", points)], until) is None


def test_a_long_history_is_thinned_and_keeps_its_last_point() -> None:
    points = [point(number / 1000, 1 + number % 5) for number in range(9000)] + [point(9.5, 7)]
    line = drawn([("owls", points)], bands=True).lines[0]
    y = {rank: at for at, rank in drawn([("owls", points)], bands=True).ranks}

    assert len(corners(line.path)) <= 2 * MAX_POINTS + 2
    assert line.end[1] == y[7]


@pytest.mark.parametrize(
    ("span", "marks"),
    [
        (timedelta(minutes=2), ["12:00:00", "12:00:30", "12:01:00", "12:01:30", "12:02:00"]),
        (timedelta(hours=4), ["12:00", "13:00", "14:00", "15:00", "16:00"]),
        (timedelta(days=4), ["1 Jun", "2 Jun", "3 Jun", "4 Jun", "5 Jun"]),
    ],
)
def test_no_two_marks_of_the_time_say_the_same(span: timedelta, marks: list[str]) -> None:
    chart = drawn([("owls", [point(0, 1), point(0, 2)])], NOON + span)

    assert [text for _, text in chart.times] == marks


def test_a_part_is_made_once_for_each_key() -> None:
    parts, made = PageParts(), []

    def make(key: str) -> Markup:
        made.append(key)
        return Markup("<b>%s</b>") % key

    shown = [parts.get(key, lambda key=key: make(key)) for key in ("a", "b", "a", "<c>", "a")]

    assert made == ["a", "b", "<c>"]
    assert shown == ["<b>a</b>", "<b>b</b>", "<b>a</b>", "<b>&lt;c&gt;</b>", "<b>a</b>"]


def test_what_was_not_used_for_the_longest_time_is_forgotten_first() -> None:
    parts, made = PageParts(most=2), []

    def ask(key: str) -> None:
        parts.get(key, lambda: made.append(key) or Markup("x"))

    for key in ("a", "b", "a", "c", "a", "b"):
        ask(key)

    assert made == ["a", "b", "c", "b"]

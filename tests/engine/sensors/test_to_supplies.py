"""Which boxes are most worth a walk, and where they are relative to the agent."""

import math
from typing import Any

import pytest
from tests.builders import lay_boxes, make_match, place

from wildscav_engine.sensors import ToSupplies
from wildscav_engine.simulation.match import Match

NEAR_POOR, FAR_RICH, ABOVE = (0.0, 0.0, 2.0), (-6.0, 0.0, 0.0), (3.0, 2.0, 0.0)


def read(match: Match, **options: Any) -> list[list[float]]:
    rows: list[list[float]] = ToSupplies(**options).read(match, [0])[0].tolist()
    return rows


@pytest.fixture
def match() -> Match:
    """An agent at the middle that faces east, with a poor box near it and a rich one farther away."""
    match = make_match("gathering")
    place(match, 0, (0.0, 0.0, 0.0), 90)
    lay_boxes(match, NEAR_POOR, FAR_RICH, ABOVE, quantity=(1, 30, 30))
    return match


def test_a_rich_box_is_worth_a_longer_walk(match: Match) -> None:
    # Efforts for their worth: 9 / 30^0.6 to the rich one, 14 / 30^0.6 to the one above, 5 to the poor one.
    rich, above, poor = read(match)
    assert rich == pytest.approx((1, 0, -1, 0, math.log(7), math.log(31)), abs=1e-6)
    assert above == pytest.approx((1, 0, 1, 2, math.log(4), math.log(31)), abs=1e-6)
    assert poor == pytest.approx((1, -1, 0, 0, math.log(3), math.log(2)), abs=1e-6)


def test_without_worth_the_least_effort_comes_first(match: Match) -> None:
    assert [row[4] for row in read(match, worth=0.0)] == pytest.approx(
        [math.log(3), math.log(7), math.log(4)], abs=1e-6
    )


def test_a_start_up_makes_near_boxes_less_attractive(match: Match) -> None:
    poor_first, rich_first = (read(match, worth=0.3, start_up=much, limit=1)[0] for much in (0.0, 100.0))
    assert (poor_first[4], rich_first[4]) == pytest.approx((math.log(3), math.log(7)), abs=1e-6)


def test_unused_rows_are_zero(match: Match) -> None:
    assert read(match, limit=5)[3:] == [[0.0] * 6] * 2

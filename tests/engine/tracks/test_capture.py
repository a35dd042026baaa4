"""Rulings on a hidden target: who knows it, and who has captured it."""

import pytest
from tests.builders import act, flat_world, make_match, place

from wildscav_engine.sensors import Compass
from wildscav_engine.simulation.match import Match


def capture(*spots: tuple[float, float, float], **spec: object) -> Match:
    match = make_match("capture", world=flat_world(size=120), seats=len(spots), target=(50, 0, 0), **spec)
    for seat, spot in enumerate(spots):
        place(match, seat, spot)
    return match


def test_nobody_is_told_where_the_target_is() -> None:
    match = capture((0, 0, 0), (0, 0, 10))
    assert match.start_info(0).target is None
    assert not Compass().read(match, [0, 1]).any()


def test_all_seats_are_one_team_and_win_together() -> None:
    match = capture((46, 0, 0), (-40, 0, 0))
    act(match, 10, seat_0={"walk_direction": 90, "walk_speed": 10})
    assert match.over
    result = match.result()
    assert result.ending == "goal"
    assert [seat.team for seat in result.seats] == [0, 0]
    assert [seat.metrics["success"] for seat in result.seats] == [1, 1]
    assert result.seats[0].metrics == result.seats[1].metrics


def test_who_comes_within_twenty_metres_finds_the_target_for_the_whole_team_and_only_for_it() -> None:
    match = capture((29.5, 0, 0), (-40, 0, 0), (-40, 0, 9), teams=(0, 0, 1))
    act(match, 1)
    assert not match.state.agents.knows_target[0].any()
    act(match, 1, seat_0={"walk_direction": 90, "walk_speed": 10})
    act(match, 1)
    assert match.state.agents.knows_target[0].tolist() == [True, True, False]
    there, elsewhere, rival = Compass().read(match, [0, 1, 2])
    assert there[3] == pytest.approx(19.5)
    assert elsewhere[3] == 90
    assert not rival.any()


def test_the_team_is_scored_by_its_nearest_member_when_the_time_is_up() -> None:
    match = capture((20, 0, 0), (-40, 0, 0), time_limit=1.0)
    act(match, 10)
    result = match.result()
    assert result.ending == "time_up"
    assert result.seats[1].metrics["punish_time"] == 2 * 30 / 10

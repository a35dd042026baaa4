"""Rulings on when a match ends and what counts."""

from typing import Any

import pytest
from tests.builders import act, box, flat_world, make_match, place

from wildscav_engine.geometry.world import Solid
from wildscav_engine.simulation.match import Match, MatchSetupError


def navigate(target: tuple[float, float, float], **spec: object) -> Match:
    return make_match("navigation", start=(0, 0, 0), target=target, **spec)


def test_reaching_the_target_ends_navigation_with_the_time_used() -> None:
    match = navigate((10, 0, 0))
    while not match.over:
        act(match, 1, seat_0={"walk_direction": 90, "walk_speed": 5})
    # 9 m at 5 m/s: the target counts from 1 m away, tested every frame of 0.1 m.
    metrics = match.result().seats[0].metrics
    assert metrics["success"] == 1
    assert metrics["used_time"] == pytest.approx(1.8, abs=0.021)
    assert metrics["time"] == metrics["used_time"]
    assert metrics["punish_time"] == 0


def test_a_target_missed_costs_twice_the_way_left_at_10_metres_a_second() -> None:
    match = navigate((15, 0, 0), time_limit=3)
    act(match, 100)
    metrics = match.result().seats[0].metrics
    assert metrics == {"time": 6.0, "used_time": 3.0, "punish_time": 3.0, "success": 0.0, "spl": 0.0}


def test_running_past_the_target_between_two_steps_counts() -> None:
    match = navigate((5.5, 0, 0.95), frames_per_action=50)
    act(match, 1, seat_0={"walk_direction": 90, "walk_speed": 10})
    assert match.over
    assert match.state.matches.reached_by[0] == 0


@pytest.mark.parametrize(("limit", "frames"), [(1.0, 50), (0.5, 25), (0.01, 1), (0.3, 15)])
def test_the_time_limit_ends_a_match_to_the_frame(limit: float, frames: int) -> None:
    match = make_match("gathering", time_limit=limit)
    act(match, 100)
    assert match.over
    assert match.frame == frames


def test_two_at_the_target_in_one_frame_have_both_reached_it() -> None:
    match = make_match("navigation", seats=3, target=(5, 0, 0))
    for seat, spot in enumerate(((3.55, 0, 0), (6.45, 0, 0), (-9, 0, 0))):
        place(match, seat, spot)
    east, west = ({"walk_direction": direction, "walk_speed": 5} for direction in (90, 270))
    act(match, 10, seat_0=east, seat_1=west)
    assert [seat.metrics["success"] for seat in match.result().seats] == [1, 1, 0]


def test_nothing_happens_after_the_end() -> None:
    match = make_match("gathering", time_limit=1)
    act(match, 30, seat_0={"walk_speed": 3})
    assert match.step_number == 10
    assert len(match.digests) == 10


WALLS = [
    *(box((5, 0, 5), (5.5, 3, 12)), box((11.5, 0, 5), (12, 3, 12))),
    *(box((5.5, 0, 5), (11.5, 3, 5.5)), box((5.5, 0, 11.5), (11.5, 3, 12))),
]


@pytest.mark.parametrize(
    ("solids", "place", "message"),
    [
        ([], {"start": (25, 0, 0)}, r"start is at x = 25.*outside the map"),
        ([], {"target": (0, 0, -99)}, "target is at"),
        ([box((-1, 0, -1), (1, 3, 1))], {"start": (0, 0, 0)}, r"start is at x = 0.*inside something"),
        (WALLS, {"target": (8, 0, 8)}, r"target is at x = 8.*no way to it"),
        (WALLS, {"start": (8, 0, 8)}, r"start is at x = 8.*no way from there"),
    ],
)
def test_a_start_or_target_that_is_no_good_is_refused_by_name(
    solids: list[Solid], place: dict[str, Any], message: str
) -> None:
    with pytest.raises(MatchSetupError, match=message):
        make_match("navigation", world=flat_world(solids=solids), **place)


def test_a_gate_leads_out_and_a_start_in_the_air_is_judged_by_where_one_comes_down() -> None:
    for solids, start in ((WALLS[1:], (8, 0, 8)), ([], (3, 4.5, 3))):
        ends: dict[str, Any] = {"start": start, "target": (-8, 0, -8)}
        assert not make_match("navigation", world=flat_world(solids=solids), **ends).over


def test_private_seeds_tell_seats_apart() -> None:
    match = make_match(seats=4)
    assert len({match.start_info(seat).seed for seat in range(4)}) == 4


def test_a_place_given_in_the_spec_is_put_onto_the_ground() -> None:
    match = navigate((10, -5, 0))
    place(match, 0, (0, 0, 0))
    assert match.start_info(0).target == (10, 0, 0)


def test_a_team_of_gatherers_is_scored_by_what_all_of_it_carry() -> None:
    match = make_match("gathering", seats=4, teams=(0, 0, 1, 1))
    match.state.agents.supplies[0] = [3, 4, 0, 9]
    assert [seat.metrics["supplies"] for seat in match.result().seats] == [7, 7, 9, 9]
    assert [seat.metrics["own_supplies"] for seat in match.result().seats] == [3, 4, 0, 9]


def test_a_supply_goal_ends_gathering_when_a_team_carries_enough() -> None:
    match = make_match("gathering", seats=3, teams=(0, 1, 1), supply_goal=12)
    supplies, agents = match.state.supplies, match.state.agents
    agents.supplies[0] = [11, 5, 0]
    act(match, 1)
    assert not match.over
    supplies.position[0, 0] = agents.position[0, 2]
    supplies.quantity[0, 0], supplies.appears[0, 0] = 7, 0
    act(match, 1, seat_2={"pick_up": 1})
    assert match.over
    assert match.result().ending == "goal"


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ({"teams": (0, 1)}, "teams has 2 entries for 3 seats"),
        ({"teams": (0, 2, 2)}, "team 1 has no seat"),
        ({"supply_goal": 5}, "supply_goal is given, but battle has no supply goal"),
        ({"zone": {"phases": ()}}, "zone is given, but battle has no zone"),
    ],
)
def test_teams_and_goals_that_do_not_fit_are_refused(spec: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make_match("battle", seats=3, **spec)

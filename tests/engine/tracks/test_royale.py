"""Rulings on the safe zone and on who outlives whom."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.builders import act, facts_of, flat_world, make_match, paid_between, place

from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.systems.zone import plan_zone, zone_at
from wildscav_engine.specs.zone_config import ZoneConfig, ZonePhase

NO_ZONE = ZoneConfig()


def royale(seats: int, **spec: object) -> Match:
    match = make_match("royale", world=flat_world(size=120), seats=seats, **{"zone": NO_ZONE, **spec})
    for seat in range(seats):
        place(match, seat, (-20 + 10 * seat, 0, 0))
    return match


def kill(match: Match, *seats: int) -> None:
    """Let some agents die in the coming frame, by nobody's hand."""
    for seat in seats:
        match.state.agents.damage[0, seat] = 1000


def test_the_dead_do_not_come_back() -> None:
    match = royale(3, time_limit=60)
    kill(match, 0)
    act(match, 200)
    assert match.state.agents.health[0].tolist() == [0, 100, 100]
    assert match.state.agents.eliminated[0].tolist() == [1, -1, -1]


@pytest.mark.parametrize(
    ("teams", "deaths", "placements", "points"),
    [
        ((0, 1, 2), ([2], [0]), [2, 1, 3], [50, 100, 0]),  # the last one standing wins
        ((0, 1, 2), ([0, 2],), [2, 1, 2], [50, 100, 50]),  # teams that go out together share their placement
        ((0, 1), ([0, 1],), [1, 1], [100, 100]),  # all who die together are first
        (
            (0, 0, 1, 1),
            ([0], [2, 3]),
            [1, 1, 2, 2],
            [100, 100, 0, 0],
        ),  # a team is in as long as one of it lives
        ((0, 0), ([0], [1]), [1, 1], [0, 0]),  # one team alone plays until it is out
    ],
)
def test_the_match_ends_with_the_last_of_these_deaths(
    teams: tuple[int, ...], deaths: tuple[list[int], ...], placements: list[int], points: list[float]
) -> None:
    match = royale(len(teams), teams=teams)
    for seats in deaths:
        assert not match.over
        kill(match, *seats)
        act(match, 1)
    result = match.result()
    assert result.ending == "last_standing"
    assert [seat.metrics["placement"] for seat in result.seats] == placements
    assert [seat.metrics["points"] for seat in result.seats] == points


def test_when_the_time_is_up_those_left_are_all_first_in_the_score_and_in_the_reward() -> None:
    match = royale(4, time_limit=0.3)
    rewards = [0.0] * 4
    for step in range(3):
        kill(match, *[3] * (step == 1))
        before = facts_of(match)
        act(match, 1)
        paid = paid_between(before, facts_of(match), outlived=1.0)["outlived"]
        rewards = [total + now for total, now in zip(rewards, paid, strict=True)]
        if step == 1:
            assert rewards == [pytest.approx(1 / 3)] * 3 + [0]
    result = match.result()
    assert result.ending == "time_up"
    assert [seat.metrics["placement"] for seat in result.seats] == [1, 1, 1, 4]
    assert [seat.metrics["points"] for seat in result.seats] == pytest.approx(
        [100 * reward for reward in rewards]
    )


def test_outside_the_zone_health_is_lost_once_a_second() -> None:
    phase = ZonePhase(wait=0, shrink=1, share=0, damage=7)
    match = royale(2, teams=(0, 0), zone=ZoneConfig(phases=(phase,)))
    act(match, 9)
    assert match.state.agents.health[0].tolist() == [100, 100]
    act(match, 1)
    assert match.state.agents.health[0].tolist() == [93, 93]
    act(match, 10)
    assert match.state.agents.health[0].tolist() == [86, 86]


@pytest.mark.parametrize(("earlier", "kills"), [(0, 1), (1, 0)])
def test_a_death_in_the_zone_counts_for_who_hit_in_the_same_step(earlier: int, kills: int) -> None:
    phase = ZonePhase(wait=0, shrink=1, share=0, damage=90)
    match = royale(2, zone=ZoneConfig(phases=(phase,)))
    place(match, 0, (-20, 0, 0), yaw=90)
    act(match, 9 - earlier)
    act(match, 1, seat_0={"shoot": 1})
    act(match, earlier)
    assert match.state.agents.health[0].tolist() == [10, 0]  # 20 by the shot, and then 90 by the zone
    assert match.state.agents.kills[0].tolist() == [kills, 0]


def test_the_default_zone_leaves_no_room_before_the_time_is_up() -> None:
    match = make_match("royale", seats=2, time_limit=100)
    zone = zone_at(match.state.matches, 0, 90 * 50)
    assert zone.radius == 0
    assert zone_at(match.state.matches, 0, 0).radius == pytest.approx(20 * np.sqrt(2))
    act(match, 1000)
    assert match.result().ending == "last_standing"


@given(st.integers(0, 2**64 - 1), st.lists(st.floats(0, 1), max_size=6))
def test_every_circle_lies_inside_the_one_before_with_its_middle_on_the_map(
    seed: int, shares: list[float]
) -> None:
    config = ZoneConfig(phases=tuple(ZonePhase(wait=1, shrink=2, share=share, damage=1) for share in shares))
    for row in plan_zone(config, 200.0, seed):
        x, z, radius = row[5] - row[2], row[6] - row[3], row[7]
        assert np.hypot(x, z) + radius <= row[4] + 1e-9
        assert max(abs(row[5]), abs(row[6])) <= 100
    same = plan_zone(config, 200.0, seed)
    assert same.tobytes() == plan_zone(config, 200.0, seed).tobytes()

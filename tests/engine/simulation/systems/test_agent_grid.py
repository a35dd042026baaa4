"""The grid of agents: what it finds is what looking at all pairs would find."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.builders import act, box, flat_world, make_match, seen_now

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.geometry.linked_grid import squares_over
from wildscav_engine.geometry.rays import raycast
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.state import NOBODY, Agents, squares_for
from wildscav_engine.simulation.systems.agent_grid import TOUCH, AgentGrid, gather_near
from wildscav_engine.simulation.systems.visibility import AGENT_LIMIT, Eye, sees_body
from wildscav_engine.simulation.systems.weapons import meet_body
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.rules import Rules

SEATS = 90
SPOTS = np.array([(x, 0.0, z) for x in range(-27, 28, 3) for z in range(-26, 28, 3)])
YARD = flat_world(60, [box((-20, 0, -1), (-4, 2.5, -0.5)), box((3, 0, 4), (3.5, 1.2, 25))])._replace(
    spawns=SPOTS
)
CROWDED = settings(max_examples=12)
SCATTERED = given(seed=st.integers(0, 10_000), spread=st.sampled_from([3.0, 12.0, 40.0]))


@pytest.fixture(scope="module")
def match() -> Match:
    return make_match(world=YARD, seats=SEATS, frames_per_action=1, rules=Rules(shot_damage=0))


def scatter(match: Match, seed: int, spread: float) -> NDArray[np.float64]:
    """Put everybody somewhere, some of them together, some dead and some outside the map."""
    random = np.random.default_rng(seed)
    agents = match.state.agents
    agents.position[0] = 0.0
    agents.position[0, :, ::2] = random.normal(0.0, spread, (SEATS, 2))
    agents.position[0, : SEATS // 8] = agents.position[0, SEATS // 8 : SEATS // 8 * 2]
    agents.yaw[0], agents.pitch[0] = random.uniform(-180, 180, SEATS), random.uniform(-20, 20, SEATS)
    agents.health[0] = np.where(random.random(SEATS) < 0.15, 0, 100)
    agents.respawn_left[0], agents.velocity[0], agents.on_ground[0] = 0, 0.0, True
    agents.clip[0], agents.fire_left[0], agents.reload_left[0] = 15, 0, 0
    return agents.position[0]


def test_a_grid_has_about_two_agents_a_square() -> None:
    assert [squares_for(seats) for seats in (1, 7, 8, 100, 1000)] == [1, 1, 2, 7, 22]


@CROWDED
@SCATTERED
def test_who_is_seen_is_what_looking_at_all_pairs_finds(match: Match, seed: int, spread: float) -> None:
    places = scatter(match, seed, spread)
    agents = Agents(*(array[0] for array in match.state.agents))
    seen = seen_now(match)
    for seat in range(0, SEATS, 3):
        listed = seen.agents[0, seat, : seen.agent_count[0, seat]].tolist()
        if agents.health[seat] <= 0:
            assert listed == []
            continue
        eye = Eye(*(places[seat] + [0.0, EYE_HEIGHT, 0.0]), agents.yaw[seat], agents.pitch[seat], 90.0)
        x, y, z = (places - places[seat]).T
        distance = x * x + y * y + z * z
        near_first = np.lexsort((np.arange(SEATS), distance)).tolist()
        in_sight = [
            other
            for other in near_first
            if other != seat and agents.health[other] > 0 and sees_body(YARD, eye, *places[other])
        ]
        assert listed == in_sight[:AGENT_LIMIT]


@CROWDED
@SCATTERED
def test_shots_hit_what_looking_at_all_bodies_finds(match: Match, seed: int, spread: float) -> None:
    scatter(match, seed, spread)
    act(match, 1, **{f"seat_{seat}": {"shoot": 1} for seat in range(SEATS)})
    agents = match.state.agents
    for seat in np.nonzero(agents.fired[0])[0].tolist():
        assert agents.hit_seat[0, seat] == first_hit(agents, seat)


def first_hit(agents: Agents, seat: int) -> int:
    """Whom a shot of a seat hits, by a look at every body."""
    x, y, z = agents.position[0, seat].tolist()
    yaw, pitch = float(agents.yaw[0, seat]), float(agents.pitch[0, seat])
    way = (sine(yaw) * cosine(pitch), -sine(pitch), cosine(yaw) * cosine(pitch))
    nearest = min(200.0, raycast(YARD, x, y + EYE_HEIGHT, z, *way, 200.0).distance)
    victim = NOBODY
    for other in range(SEATS):
        if other == seat or agents.health[0, other] <= 0:
            continue
        there = agents.position[0, other].tolist()
        distance = meet_body(x - there[0], y + EYE_HEIGHT - there[1], z - there[2], *way)
        if distance < nearest:
            nearest, victim = distance, other
    return victim


@CROWDED
@SCATTERED
def test_who_can_be_touched_is_what_a_look_at_all_pairs_finds(match: Match, seed: int, spread: float) -> None:
    places = scatter(match, seed, spread)
    agents = match.state.agents
    seen_now(match)  # which indexes them
    random = np.random.default_rng(seed)
    places[:, ::2] += random.uniform(-0.2, 0.2, (SEATS, 2))  # as far as they may have moved since
    squares = squares_over(YARD, squares_for(SEATS))
    grid = AgentGrid(squares, match.state.matches.agent_squares[0], agents.next_in_square[0])
    for seat in range(SEATS):
        near = np.zeros(SEATS, np.int32)
        count = gather_near(grid, agents.position[0], seat, near)
        away = np.abs(places - places[seat])
        touched = (agents.health[0] > 0) & (away[:, 0] <= TOUCH) & (away[:, 2] <= TOUCH)
        touched[seat] = False
        assert sorted(near[:count].tolist()) == np.nonzero(touched)[0].tolist()


def test_who_comes_back_keeps_away_from_the_living(match: Match) -> None:
    places = scatter(match, 5, 12.0)
    agents = match.state.agents
    agents.health[0, 40:] = 0
    agents.respawn_left[0, 40:60] = 1
    before = places.copy()
    act(match, 1)
    for seat in range(40, 60):
        assert agents.health[0, seat] > 0
        others = np.nonzero(np.isin(np.arange(SEATS), range(40)) & (agents.health[0] > 0))[0]
        away = np.hypot(*(before[others] - agents.position[0, seat])[:, ::2].T)
        assert away.min() > 1.8

"""Rulings on motion: what a body can do, and what it never does."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from builders import act, box, flat_world, make_match, map_from, place
from wildscav_engine.body import BODY_HEIGHT, BODY_RADIUS, JUMP_SPEED
from wildscav_engine.geometry.shapes import box as solid_box
from wildscav_engine.geometry.shapes import pose
from wildscav_engine.geometry.sweep import SKIN
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import Kind, Solid, World, build_world, convex_solid
from wildscav_engine.maps import generate_map
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.match import Match
from wildscav_engine.spec import MapConfig, MatchSpec


def position(match: Match, seat: int = 0) -> np.ndarray:
    return match.state.agents.position[0, seat].copy()


@pytest.mark.parametrize(
    ("direction", "x", "z"),
    [
        (0, 0, 10),
        (90, 10, 0),
        (180, 0, -10),
        (270, -10, 0),
        (-90, -10, 0),
        (450, 10, 0),
        (45, 7.0711, 7.0711),
    ],
)
def test_walking_5_metres_a_second_for_2_seconds_moves_10_metres(
    direction: float, x: float, z: float
) -> None:
    match = make_match()
    place(match, 0, (0, 0, 0))
    act(match, 20, seat_0={"walk_direction": direction, "walk_speed": 5})
    assert position(match) == pytest.approx([x, 0, z], abs=1e-3)
    assert match.state.agents.walked[0, 0] == pytest.approx(10, abs=1e-6)


@pytest.mark.parametrize("action", [{"walk_speed": 10.001}, {"walk_speed": -1}, {"walk_speed": math.nan}])
def test_an_impossible_walk_speed_is_no_action(action: dict[str, float]) -> None:
    match = make_match()
    place(match, 0, (0, 0, 0))
    act(match, 5, seat_0={**action, "turn": 3})
    assert position(match) == pytest.approx([0, 0, 0])
    assert match.state.agents.yaw[0, 0] == 0


@pytest.mark.parametrize("angle", [3e38, -3e38, 1e9])
def test_absurd_but_finite_angles_are_directions_too(angle: float) -> None:
    match = make_match()
    place(match, 0, (0, 0, 0))
    act(match, 10, seat_0={"walk_direction": angle, "walk_speed": 5, "turn": angle, "look": angle})
    assert match.state.agents.walked[0, 0] == pytest.approx(5)
    assert -180 < match.state.agents.yaw[0, 0] <= 180
    assert abs(match.state.agents.pitch[0, 0]) == 90


def test_turns_are_degrees_a_frame_and_looks_stop_at_straight_up_and_down() -> None:
    match = make_match()
    act(match, 1, seat_0={"turn": 10, "look": 3})
    assert match.state.agents.yaw[0, 0] == pytest.approx(50)
    assert match.state.agents.pitch[0, 0] == pytest.approx(15)
    act(match, 4, seat_0={"turn": 10, "look": 10})
    assert match.state.agents.yaw[0, 0] == pytest.approx(-110)
    assert match.state.agents.pitch[0, 0] == 90


def test_water_halves_the_speed() -> None:
    match = make_match(world=flat_world(water=0.8))
    place(match, 0, (0, 0, 0))
    act(match, 10, seat_0={"walk_direction": 90, "walk_speed": 8})
    assert position(match)[0] == pytest.approx(4)
    assert match.state.agents.in_water[0, 0]


@pytest.mark.parametrize(("top", "passes"), [(0.3, True), (0.4995, True), (0.5, True), (0.51, False)])
def test_steps_up_to_half_a_metre_are_walked_onto(top: float, passes: bool) -> None:
    match = make_match(world=flat_world(solids=[box((3, 0, -5), (8, top, 5), Kind.STAIR)]))
    place(match, 0, (0, 0, 0))
    act(match, 10, seat_0={"walk_direction": 90, "walk_speed": 5})
    assert (position(match)[0] > 4) == passes
    assert position(match)[1] == pytest.approx(top if passes else 0, abs=3 * SKIN)


def test_steps_of_just_half_a_metre_are_walked_up_and_down_and_never_fallen_off() -> None:
    steps = [box((2 + n, 0, -5), (12, 0.5 * (n + 1), 5), Kind.STAIR) for n in range(4)]
    match = make_match(world=flat_world(solids=steps), frames_per_action=1)
    place(match, 0, (0, 0, 0))
    highest = 0.0
    for direction in (90, 270):
        for _ in range(80):
            act(match, 1, seat_0={"walk_direction": direction, "walk_speed": 5})
            assert match.state.agents.on_ground[0, 0]
            highest = max(highest, position(match)[1])
    assert highest == pytest.approx(2.0, abs=3 * SKIN)
    assert position(match) == pytest.approx([0, 0, 0], abs=0.01)


def test_a_jump_rises_as_high_as_gravity_allows_and_takes_a_second() -> None:
    match = make_match()
    place(match, 0, (0, 0, 0))
    heights = []
    act(match, 1, seat_0={"jump": 1})
    while not match.state.agents.on_ground[0, 0]:
        heights.append(position(match)[1])
        act(match, 1)
    assert max(heights) == pytest.approx(JUMP_SPEED**2 / (2 * 9.81), abs=0.02)
    assert 0.9 <= (len(heights) + 1) / 10 <= 1.2
    assert position(match)[1] == 0


def test_a_metre_high_wall_is_jumped_onto() -> None:
    match = make_match(world=flat_world(solids=[box((1.5, 0, -5), (8, 1, 5))]))
    place(match, 0, (0, 0, 0))
    act(match, 20, seat_0={"walk_direction": 90, "walk_speed": 4, "jump": 1})
    assert position(match)[0] > 3


def test_a_ceiling_stops_a_jump() -> None:
    match = make_match(world=flat_world(solids=[box((-5, 2.2, -5), (5, 2.4, 5), Kind.FLOOR)]))
    place(match, 0, (0, 0, 0))
    for _ in range(10):
        act(match, 1, seat_0={"jump": 1})
        assert position(match)[1] <= 2.2 - BODY_HEIGHT


def test_a_doorway_is_walked_through_and_a_slit_is_not() -> None:
    def walk(width: float) -> float:
        half = width / 2
        walls = [
            box((5, 0, -10), (5.25, 3, -half)),
            box((5, 0, half), (5.25, 3, 10)),
            box((5, 2.3, -half), (5.25, 3, half)),
        ]
        match = make_match(world=flat_world(solids=walls))
        place(match, 0, (0, 0, 0))
        act(match, 20, seat_0={"walk_direction": 90, "walk_speed": 5})
        return float(position(match)[0])

    assert walk(1.3) == pytest.approx(10, abs=1e-3)
    assert walk(0.85) == pytest.approx(5 - BODY_RADIUS, abs=0.01)


def test_walls_are_slid_along() -> None:
    match = make_match(world=flat_world(solids=[box((3, 0, -15), (4, 3, 15))]))
    place(match, 0, (0, 0, 0))
    act(match, 20, seat_0={"walk_direction": 45, "walk_speed": 5})
    assert position(match) == pytest.approx([3 - BODY_RADIUS, 0, 7.07], abs=0.01)


@pytest.mark.parametrize(("slope", "climbs"), [(0.5, True), (0.95, True), (1.2, False)])
def test_ground_is_climbed_up_to_45_degrees(slope: float, climbs: bool) -> None:
    match = make_match(world=flat_world(slope=slope))
    place(match, 0, (0, 0, 0))
    act(match, 10, seat_0={"walk_direction": 90, "walk_speed": 5})
    assert (position(match)[0] > 4.9) == climbs
    assert (position(match)[0] < 0.01) != climbs


@pytest.mark.parametrize("degrees", [47, 50, 60, 75, 85])
@pytest.mark.parametrize("action", [{"walk_speed": 10}, {"walk_speed": 10, "jump": 1}])
def test_nobody_climbs_steeper_ground_at_any_speed_jumping_or_not(
    degrees: float, action: dict[str, float]
) -> None:
    match = make_match(world=flat_world(slope=math.tan(math.radians(degrees))))
    place(match, 0, (0, 0, 0))
    act(match, 100, seat_0={"walk_direction": 90, **action})
    assert position(match)[0] < 0.7


@pytest.mark.parametrize("jump", [0, 1])
def test_a_cliff_is_not_walked_up_from_level_ground(jump: float) -> None:
    world = flat_world()
    world.heights[:, 12:] = 8.0  # 8 m up within one cell, from x = 2 to x = 4
    match = make_match(world=world)
    place(match, 0, (-5, 0, 0))
    act(match, 50, seat_0={"walk_direction": 90, "walk_speed": 10, "jump": jump})
    assert position(match)[0] < 2.7
    assert position(match)[1] < 2.5


def test_nobody_jumps_in_water() -> None:
    match = make_match(world=flat_world(water=0.8))
    place(match, 0, (0, 0, 0))
    act(match, 20, seat_0={"walk_direction": 90, "walk_speed": 10, "jump": 1})
    assert position(match) == pytest.approx([10, 0, 0])


def test_whoever_stands_on_steeper_ground_slides_down() -> None:
    match = make_match(world=flat_world(slope=1.2))
    place(match, 0, (0, 0, 0))
    act(match, 10)
    assert position(match)[0] == pytest.approx(-5, abs=0.1)


@pytest.mark.parametrize("action", [{"walk_speed": 10}, {"walk_speed": 10, "jump": 1}])
def test_nobody_holds_on_to_ground_that_is_too_steep(action: dict[str, float]) -> None:
    match = make_match(world=flat_world(slope=1.2))
    place(match, 0, (10, 12, 0))
    act(match, 10, seat_0={"walk_direction": 90, **action})  # uphill
    assert position(match)[0] == pytest.approx(5, abs=0.2)


def test_at_the_bottom_of_a_gully_one_stands_walks_along_and_jumps() -> None:
    world = flat_world()
    world.heights[:] = 1.5 * np.abs(np.arange(21) * 2.0 - 20.0)  # both sides 56° steep
    match = make_match(world=world)
    place(match, 0, (3, 4.5, 0))
    act(match, 20)
    assert abs(position(match)[0]) < 0.1
    act(match, 10, seat_0={"walk_direction": 0, "walk_speed": 5})
    assert position(match)[2] == pytest.approx(5, abs=0.1)
    act(match, 5, seat_0={"jump": 1})
    assert position(match)[1] > 1.0


def steep_roof(ridge: float, foot: float) -> Solid:
    """A roof that rises at 63° from its foot to its ridge, x in m."""
    top = 2.0 * abs(ridge - foot)
    corners = [(x, y, z) for z in (-4, 4) for x, y in ((foot, 0), (ridge, 0), (ridge, top))]
    faces = ((0, 1, 2), (3, 4, 5), (0, 1, 4), (1, 2, 5), (0, 2, 5))
    return convex_solid(Kind.ROOF, np.array(corners, float), faces)


def test_nobody_runs_or_jumps_up_a_steep_roof() -> None:
    match = make_match(world=flat_world(solids=[steep_roof(ridge=6, foot=3)]))
    place(match, 0, (0, 0, 0))
    highest = 0.0
    for _ in range(40):
        act(match, 1, seat_0={"walk_direction": 90, "walk_speed": 10, "jump": 1})
        highest = max(highest, position(match)[1])
    assert highest <= JUMP_SPEED**2 / (2 * 9.81)


def test_who_falls_between_steep_roofs_stands_there_and_can_jump() -> None:
    roofs = [steep_roof(ridge=6, foot=0), steep_roof(ridge=-6, foot=0)]
    match = make_match(world=flat_world(solids=roofs))
    place(match, 0, (1, 8, 0))
    match.state.agents.on_ground[0, 0] = False
    act(match, 40)
    low = position(match)[1]
    act(match, 10)
    assert position(match)[1] == pytest.approx(low, abs=0.01)
    assert match.state.agents.velocity[0, 0, 1] > -0.5  # however long it was held up
    act(match, 5, seat_0={"jump": 1})
    assert position(match)[1] > low + 0.5


def test_heads_are_stood_on_until_they_go_away() -> None:
    match = make_match(seats=2)
    place(match, 0, (0, 0, 0))
    place(match, 1, (0, 3, 0))
    match.state.agents.on_ground[0, 1] = False
    act(match, 10)
    assert position(match, 1)[1] == pytest.approx(BODY_HEIGHT, abs=3 * SKIN)
    assert match.state.agents.on_ground[0, 1]
    act(match, 10, seat_0={"walk_direction": 90, "walk_speed": 5})
    assert position(match, 1)[1] == 0


def test_a_fall_accelerates_and_lands() -> None:
    match = make_match()
    place(match, 0, (0, 20, 0))
    match.state.agents.on_ground[0, 0] = False
    act(match, 10)
    assert position(match)[1] == pytest.approx(20 - 9.81 / 2, abs=1e-9)
    act(match, 20)
    assert position(match)[1] == 0
    assert match.state.agents.velocity[0, 0, 1] == 0


def test_stairs_are_walked_up_and_down() -> None:
    steps = [box((2 + 0.25 * i, 0, -1), (8, 0.2 * (i + 1), 1), Kind.STAIR) for i in range(12)]
    match = make_match(world=flat_world(solids=steps))
    place(match, 0, (0, 0, 0))
    act(match, 14, seat_0={"walk_direction": 90, "walk_speed": 5})
    assert position(match)[1] == pytest.approx(2.4, abs=3 * SKIN)
    act(match, 14, seat_0={"walk_direction": 270, "walk_speed": 5})
    assert position(match) == pytest.approx([0, 0, 0], abs=0.01)


def test_bodies_do_not_walk_through_each_other() -> None:
    match = make_match(seats=2)
    place(match, 0, (0, 0, 0))
    place(match, 1, (3, 0, 0))
    act(match, 10, seat_0={"walk_direction": 90, "walk_speed": 5})
    assert position(match)[0] == pytest.approx(3 - 2 * BODY_RADIUS, abs=0.01)


def test_nobody_leaves_the_map() -> None:
    match = make_match()
    place(match, 0, (15, 0, 15))
    act(match, 30, seat_0={"walk_direction": 45, "walk_speed": 10})
    assert position(match) == pytest.approx([19.5, 0, 19.5])


@pytest.mark.parametrize(
    ("bodies", "solids"),
    [
        ([(0, 19.04)], []),
        ([(1.2 * n, 19.04 - 0.05 * n) for n in range(8)], []),
        ([], [solid_box(Kind.WALL, pose(0.0, 18.5, -12.0), (-6.0, 0.0, -0.25), (6.0, 2.0, 0.25))]),
    ],
)
def test_what_stands_at_the_edge_leads_nobody_over_it(
    bodies: list[tuple[float, float]], solids: list[Solid]
) -> None:
    """The edge of the map is at z = 20, and a body keeps half a metre off it."""
    match = make_match(world=flat_world(solids=solids), seats=1 + len(bodies), frames_per_action=1)
    place(match, 0, (-8, 0, 19.5))
    for seat, (x, z) in enumerate(bodies, start=1):
        place(match, seat, (x, 0, z))
    for direction in (90, 80, 100, 45, 135):
        for jump in (0, 1):
            place(match, 0, (-8, 0, 19.5))
            for _ in range(100):
                before = position(match)
                act(match, 1, seat_0={"walk_direction": direction, "walk_speed": 10, "jump": jump})
                way = position(match) - before
                assert position(match)[2] <= 19.5 + 1e-9
                assert math.hypot(way[0], way[2]) <= 0.2 + 1e-9


def test_a_body_beyond_the_margin_is_not_pulled_back_but_walks_back() -> None:
    match = make_match(frames_per_action=1)
    place(match, 0, (0, 0, 19.9))
    act(match, 1, seat_0={"walk_direction": 0, "walk_speed": 10})
    assert position(match) == pytest.approx([0, 0, 19.9])
    act(match, 1, seat_0={"walk_direction": 135, "walk_speed": 10})
    assert position(match) == pytest.approx([0.2 * math.sqrt(0.5), 0, 19.9 - 0.2 * math.sqrt(0.5)])


@pytest.mark.parametrize(("along", "climbs"), [(0.5, True), (0.95, True), (1.1, False)])
def test_between_steep_ground_and_the_edge_one_walks_along_as_in_a_gully(along: float, climbs: bool) -> None:
    """The ground is 60° steep and falls to the edge in the east; northwards it rises ``along`` m a metre."""
    side = np.arange(21) * 2.0 - 20.0
    outwards = math.sqrt(3.0 - along * along)
    heights = along * side[:, None] - outwards * side[None, :]
    world = build_world((-20.0, -20.0), heights, np.full((20, 20), -np.inf), [], flat_world().spawns)
    match = make_match(world=world)
    for x, expected in ((19.5, climbs), (0.0, False)):
        place(match, 0, (x, ground_at(world, x, 0.0).height, 0.0))
        before = position(match)[1]
        act(match, 6, seat_0={"walk_direction": 0, "walk_speed": 10})
        assert (position(match)[1] > before + 0.5) == expected


def test_a_thin_wall_stops_the_fastest_fall() -> None:
    match = make_match(world=flat_world(solids=[box((-5, 5, -5), (5, 5.02, 5), Kind.ROOF)]))
    place(match, 0, (0, 60, 0))
    match.state.agents.on_ground[0, 0] = False
    match.state.agents.velocity[0, 0, 1] = -50
    act(match, 20)
    assert position(match)[1] == pytest.approx(5.02, abs=3 * SKIN)


def test_a_gentle_roof_is_walked_on_and_a_steep_one_slides() -> None:
    def stand(height: float) -> float:
        ridge = [(-6, 0, 0), (6, 0, 0), (0, height, 0)]
        vertices = np.array([(x, y, z) for z in (-4, 4) for x, y, _ in ridge], float)
        faces = ((0, 1, 2), (3, 4, 5), (0, 1, 4), (1, 2, 5), (0, 2, 5))
        match = make_match(world=flat_world(solids=[convex_solid(Kind.ROOF, vertices, faces)]))
        place(match, 0, (-3, height / 2 + 0.5, 0))
        match.state.agents.on_ground[0, 0] = False
        act(match, 30)
        return float(position(match)[1])

    assert stand(3.0) > 1.4
    assert stand(9.0) == pytest.approx(0, abs=0.01)


@pytest.fixture(scope="module")
def country() -> GameMap:
    return generate_map(MapConfig(size=60, houses=3, storeys=(1, 3), vegetation=0.8), 4)


def depth_inside(world: World, place: np.ndarray) -> float:
    """How deep a body is inside the solid that it is deepest in, m; negative: how far it keeps off."""
    margin = np.array([BODY_RADIUS, 0.0, BODY_RADIUS])
    head = np.array([0.0, BODY_HEIGHT, 0.0])
    outside = np.maximum(world.solid_low - margin - head - place, place - world.solid_high - margin).max(
        axis=1
    )
    for solid in np.flatnonzero(outside < 0):
        rows = slice(world.solid_start[solid], world.solid_start[solid + 1])
        faces = world.faces[rows]
        beyond = faces[:, :3] @ place - faces[:, 3] - world.face_reach[rows]
        outside[solid] = max(outside[solid], beyond.max())
    return float(-outside.min()) if len(outside) else -np.inf


def check_invariants(match: Match) -> None:
    agents, world = match.state.agents, match.game_map.world
    assert np.isfinite(agents.position).all()
    speeds = np.hypot(agents.velocity[0, :, 0], agents.velocity[0, :, 2])
    assert speeds.max() <= 10 + 1e-9
    for seat in range(match.seats):
        here = agents.position[0, seat]
        assert here[1] >= ground_at(world, here[0], here[2]).height - 1e-9
        assert depth_inside(world, here) < 0


@settings(max_examples=15)
@given(st.integers(0, 2**31), st.floats(1, 10), st.floats(0, 0.5))
def test_nobody_is_ever_inside_anything(country: GameMap, seed: int, speed: float, jumps: float) -> None:
    game_map = country
    spec = MatchSpec(
        track="gathering", map=game_map.spec, seed=seed, seats=("submission",) * 6, time_limit=60
    )
    match = Match(spec, game_map)
    random = np.random.default_rng(seed)
    for seat in range(0, 6, 2):  # half of them start indoors
        place(match, seat, random.choice(country.indoor) + np.array([0, 2 * SKIN, 0]))
    rows = np.zeros((6, 8), np.float32)
    for _ in range(100):
        turned = random.random(6) < 0.15
        rows[turned, 0] = random.uniform(0, 360, turned.sum())
        rows[:, 1], rows[:, 4] = speed, random.random(6) < jumps
        match.step(rows)
        check_invariants(match)


def test_many_random_frames_on_a_map_by_hand_keep_within_bounds() -> None:
    match = Match(
        MatchSpec(track="gathering", seats=("submission",) * 2, time_limit=60),
        map_from(flat_world(solids=[box((-2, 0, -2), (2, 2, 2)), box((-2, 2.5, -6), (2, 3, 6))])),
    )
    random = np.random.default_rng(1)
    for _ in range(300):
        rows = np.zeros((2, 8), np.float32)
        rows[:, 0], rows[:, 1], rows[:, 4] = random.uniform(0, 360, 2), 10, 1
        match.step(rows)
        check_invariants(match)

"""Where matches start: given places, places drawn apart, and places around a target."""

import itertools

import numpy as np
import pytest
from pydantic import ValidationError
from tests.builders import box, flat_world, map_from

from wildscav_engine.maps import GameMap, load_map
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.setup.drawn_starts import START_DISTANCE
from wildscav_engine.simulation.setup.starts import MatchSetupError, choose_starts, usable_place
from wildscav_engine.specs.actions import no_actions
from wildscav_engine.specs.body import BODY_RADIUS
from wildscav_engine.specs.match_spec import MatchSpec

MEADOW = map_from(flat_world())
# A wall all along the meadow, with a gap in the middle.
WALLED = map_from(flat_world(solids=[box((-20, 0, 2), (-2, 3, 3)), box((2, 0, 2), (20, 3, 3))]))
# A low floor that one steps onto, in the middle between two walls.
BETWEEN = (box((1, 0, -9), (2, 3, 9)), box((-2, 0, -9), (-1.9, 3, 9)))
BLOCKED = map_from(flat_world(solids=[*BETWEEN, box((-0.8, 0.2, -1), (0.8, 0.4, 1))]))
LANE = (box((-20, 0, 0.6), (20, 3, 20)), box((-20, 0, -20), (20, 3, -0.6)))  # two walls, 1.2 m apart
LIFTED = 3e-3  # m, more than a given start is lifted off the ground


def spec(seed: int = 0, seats: int = 1, track: str = "navigation", **fields: object) -> MatchSpec:
    return MatchSpec(track=track, seed=seed, seats=("submission",) * seats, **fields)


def starts_of(wanted: MatchSpec, game_map: object = MEADOW) -> np.ndarray:
    return choose_starts(wanted, game_map, has_target=True)[0]


def test_every_seat_may_have_its_own_start_and_the_others_keep_away() -> None:
    places = ((-8.0, 0.0, 4.0), None, (0.0, 0.0, -8.0), None)
    for seed in range(20):
        starts = starts_of(spec(seed, 4, "battle", starts=places))
        assert abs(starts[0] - places[0]).max() < LIFTED
        assert abs(starts[2] - places[2]).max() < LIFTED
        assert least_distance(starts) >= START_DISTANCE


def test_a_start_of_the_first_seat_alone_leaves_the_others_to_chance() -> None:
    first, second = (starts_of(spec(seed, 3, "battle", start=(1.0, 0.0, 1.0))) for seed in range(2))
    assert abs(first[0] - (1.0, 0.0, 1.0)).max() < LIFTED
    assert (first[0] == second[0]).all()
    assert (first[1:] != second[1:]).any()


@pytest.mark.parametrize(
    ("fields", "fault"),
    [
        ({"start": (0, 0, 0), "starts": ((0, 0, 0),)}, "start and starts are both given"),
        ({"starts": (None, None)}, "starts has 2 entries for 1 seats"),
        ({"start_range": -1.0}, "start_range"),
        ({"start_range": 2.0, "track": "battle"}, "battle has no start range"),
    ],
)
def test_starts_that_make_no_sense_are_refused(fields: dict[str, object], fault: str) -> None:
    with pytest.raises(ValidationError, match=fault):
        spec(**fields)


def test_a_start_that_is_no_good_is_named_by_its_seat() -> None:
    with pytest.raises(MatchSetupError, match="start of seat 1 is at x = 500"):
        starts_of(spec(0, 2, "battle", starts=(None, (500.0, 0.0, 0.0))))


def test_wherever_a_body_stands_one_may_start() -> None:
    """However near to a wall it is, and though places are often told in millimetres only."""
    for beside in (2.0, 2.001, 2.03):  # m, of the wall's east face; a body needs 0.45 m
        place = (beside + 0.45, 0.0, 0.0)
        assert usable_place(BLOCKED, place, None) == place
    inside = (2.44, 0.0, 0.0)
    assert usable_place(BLOCKED, inside, None) != inside


def test_every_place_of_a_map_may_be_given() -> None:
    game_map = load_map(101)
    for place in np.concatenate([game_map.indoor, game_map.outdoor[::20]]).round(3).tolist():
        assert usable_place(game_map, tuple(place), None) == tuple(place)


@pytest.mark.parametrize("below", [0.0, 0.0005, 0.01, 0.05])
def test_a_start_a_little_below_a_floor_is_on_it(below: float) -> None:
    """No floor holds a body that is inside it: it would fall to the ground."""
    match = Match(spec(start=(0.0, 0.4 - below, 0.0)), BLOCKED)
    for _ in range(10):
        match.step(no_actions(1))
    assert match.state.agents.position[0, 0, 1] == pytest.approx(0.4, abs=LIFTED)


def test_starts_lie_around_the_target_as_far_as_the_range_says() -> None:
    target, reach = np.array([1.0, 0.0, -3.0]), 1.0
    around: dict[str, object] = {"target": tuple(target), "start_range": 2.0}
    ways = np.array([starts_of(spec(seed, **around))[0] - target for seed in range(400)])
    far = np.hypot(ways[:, 0], ways[:, 2]) - reach
    assert far.min() >= 0.0
    assert far.mean() == pytest.approx(2.0 * np.sqrt(2.0 / np.pi), rel=0.1)  # of |N(0, 2)|
    assert abs(ways[:, 0].mean()) < 0.3
    assert abs(ways[:, 2].mean()) < 0.3
    assert (ways[:, 1] == 0.0).all()


def test_a_start_around_the_target_is_never_inside_anything() -> None:
    for seed in range(100):
        x, _, z = starts_of(spec(seed, target=(5.0, 0.0, 0.0), start_range=4.0), WALLED)[0]
        assert not (1.55 < z < 3.45 and abs(x) > 2.45)
        assert max(abs(x), abs(z)) <= 19.5


def test_seats_that_race_start_beside_each_other_and_not_in_each_other() -> None:
    starts = starts_of(spec(3, 4, target=(0.0, 0.0, 0.0), start_range=5.0))
    assert least_distance(starts) >= 1.8


def meadow_with(spots: list[tuple[float, float]], solids: tuple[object, ...] = ()) -> GameMap:
    world = flat_world(solids=solids)
    return map_from(world._replace(spawns=np.array([(x, 0.0, z) for x, z in spots])))


def least_distance(starts: np.ndarray) -> float:
    return min(np.hypot(*(one - other)[::2]) for one, other in itertools.combinations(starts, 2))


@pytest.mark.parametrize("seed", range(5))
def test_where_places_are_few_every_seat_gets_one_of_its_own(seed: int) -> None:
    crowded = meadow_with([(1.2 * n, 0.0) for n in range(12)])
    assert least_distance(starts_of(spec(seed, 12, "battle"), crowded)) >= 1.2 - 1e-9
    # A few of many keep as far apart as they can.
    assert least_distance(starts_of(spec(seed, 4, "battle"), crowded)) >= 2.4 - 1e-9


def test_drawn_starts_keep_off_given_ones_where_places_are_few() -> None:
    crowded = meadow_with([(0.0, 0.0), (0.5, 0.0), (0.0, 5.0)])
    starts = starts_of(spec(0, 2, "battle", starts=(None, (0.2, 0.0, 0.0))), crowded)
    assert starts[0].tolist() == [0.0, 0.0, 5.0]


@pytest.mark.parametrize("fields", [{"track": "battle"}, {"target": (0.0, 0.0, 0.0), "start_range": 0.5}])
def test_more_seats_than_have_room_are_refused(fields: dict[str, object]) -> None:
    # The target lies between two walls, where a few have room, and not thirty.
    pen = meadow_with([(3.0, 0.0), (3.3, 0.0), (5.0, 0.0)], LANE if "target" in fields else ())
    with pytest.raises(MatchSetupError, match=r"seats are too many for this map: it has 3 places"):
        starts_of(spec(0, 30, **fields), pen)


@pytest.mark.parametrize("seed", range(8))
def test_seats_that_race_in_a_narrow_place_do_not_start_in_each_other(seed: int) -> None:
    lane = meadow_with([(float(x), 0.0) for x in range(-18, 19)], LANE)
    starts = starts_of(spec(seed, 20, target=(0.0, 0.0, 0.0), start_range=0.3), lane)
    assert least_distance(starts) >= 2 * BODY_RADIUS

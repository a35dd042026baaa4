"""Rulings on what agents are told under each of the rule ``senses``."""

from collections.abc import Sequence

import pytest
from tests.builders import act, box, flat_world, lay_boxes, make_match, place, seen_now

from wildscav_engine.sensors import (
    DepthCamera,
    Lidar,
    NearbySupplies,
    SegmentationCamera,
    Sights,
    VisibleAgents,
    allowed_sensors,
)
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.rules import Rules, Senses

WALL = box((-3, 0, 5), (3, 3, 5.3))


def meeting(senses: Senses) -> Match:
    """Seat 0 looks north at seat 1, which walks east at 2 m/s and has lost 30 of its 100 hp."""
    match = make_match(seats=2, rules=Rules(senses=senses))
    place(match, 0, (0, 0, 0))
    place(match, 1, (3, 0, 8), yaw=-90)
    act(match, 1, seat_1={"walk_direction": 90, "walk_speed": 2})
    match.state.agents.health[0, 1] = 70
    match.state.agents.invincible_left[0, 1] = 5
    return match


def boxes(senses: Senses, *places: Sequence[float], behind_wall: bool = False) -> tuple[int, bool]:
    """How many boxes an agent at the origin is told of that looks north, and whether it can pick one up."""
    match = make_match(world=flat_world(80, [WALL] if behind_wall else []), rules=Rules(senses=senses))
    place(match, 0, (0, 0, 0))
    lay_boxes(match, *places)
    seen = seen_now(match)
    return int(seen.supply_count[0, 0]), bool(seen.can_pick_up[0, 0])


@pytest.mark.parametrize(
    ("place", "behind_wall", "sighted"),
    [
        ((0, 0, 10), False, 1),
        ((0, 0, 10), True, 0),
        ((0, 0, -10), False, 0),
        ((9.5, 0, 10), False, 1),  # 43.5° to the right: the view is 90° wide
        ((10.5, 0, 10), False, 0),
        ((0, 9, 10), False, 0),  # above the view
        ((0, 0, 1), False, 0),  # at its feet, below the view
        ((0, 0, 21), False, 0),  # beyond ``supply_sight``
    ],
)
def test_boxes_are_listed_by_the_eyes_alone(
    place: tuple[float, ...], behind_wall: bool, sighted: int
) -> None:
    near = place[2] <= 20
    assert boxes(Senses.ORIGINAL, place, behind_wall=behind_wall)[0] == near
    assert boxes(Senses.SIGHTED, place, behind_wall=behind_wall)[0] == sighted
    assert boxes(Senses.PIXELS, place, behind_wall=behind_wall)[0] == 0


@pytest.mark.parametrize("senses", Senses)
def test_a_box_in_reach_is_felt_whoever_sees_it(senses: Senses) -> None:
    assert boxes(senses, (0, 0, -1))[1]
    assert not boxes(senses, (0, 0, -2))[1]


def test_the_condition_of_an_enemy_is_known_with_the_original_senses_alone() -> None:
    rows = {senses: VisibleAgents().read(meeting(senses), [0])[0, 0] for senses in Senses}
    assert rows[Senses.ORIGINAL][7:] == pytest.approx([2, 0, 0, -90, 70, 1], abs=1e-5)
    assert rows[Senses.SIGHTED][7:] == pytest.approx([0, 0, 0, -90, 0, 1])
    assert (rows[Senses.SIGHTED][:7] == rows[Senses.ORIGINAL][:7]).all()
    assert not rows[Senses.PIXELS].any()


def test_who_cannot_tell_velocities_aims_where_the_enemy_is() -> None:
    original, sighted = (Sights().read(meeting(senses), [0])[0, 0] for senses in list(Senses)[:2])
    assert original[3] > original[1]
    assert sighted[3] == sighted[1] == original[1]
    assert (sighted[8], sighted[9]) == (0, 1)


def test_robots_see_under_all_senses() -> None:
    for senses, told in ((Senses.PIXELS, [0, 1]), (Senses.SIGHTED, [1, 1])):
        match = meeting(senses)
        place(match, 1, (0, 0, 8), yaw=180)
        match.state.agents.robot[0, 1] = 30
        assert seen_now(match).agent_count[0].tolist() == told


@pytest.mark.parametrize("senses", Senses)
def test_no_image_shows_who_is_out_of_view(senses: Senses) -> None:
    """Seat 1 stands behind, and seat 2 62° to the right of a view that is 90° wide."""
    match = make_match(seats=3)
    for seat, there in enumerate(((0, 0, 0), (0, 0, -4), (7, 0, 3.7))):
        place(match, seat, there)
    wanted = {
        "lidar": Lidar(channels=1, lowest=0, highest=0, azimuths=4, moving=True),
        "segmentation": SegmentationCamera(64, 36, field_of_view=170, label="instance"),
        "depth": DepthCamera(field_of_view=170),  # shows neither agents nor boxes
        "boxes": NearbySupplies(),
    }
    allowed = allowed_sensors(wanted, Rules(senses=senses))
    is_original = senses == Senses.ORIGINAL
    assert (allowed["lidar"].read(match, [0])[0, 0, 2] < 5) == is_original
    assert (10002 in allowed["segmentation"].read(match, [0])) == is_original
    assert (allowed["depth"], allowed["boxes"]) == (wanted["depth"], wanted["boxes"])

"""The segmentation camera labels each pixel by what is there, or by which thing it is."""

import numpy as np
import pytest
from tests.builders import act, box, flat_world, make_match, place

from wildscav_engine.geometry.world import Kind, Solid
from wildscav_engine.sensors import SegmentationCamera
from wildscav_engine.sensors.optics.segmentation import FIRST_AGENT, FIRST_BOX, FIRST_SOLID
from wildscav_engine.simulation.match import Match

KINDS = SegmentationCamera(width=65, height=37)
INSTANCES = SegmentationCamera(width=65, height=37, label="instance")


def duel(*solids: Solid, distance: float = 6.0, water: float = -np.inf) -> Match:
    """Seat 0 at the origin, looking north; seat 1 north of it."""
    match = make_match(world=flat_world(80, solids, water=water), seats=2)
    match.state.supplies.quantity[:] = 0
    place(match, 0, (0, 0, 0))
    place(match, 1, (0, 0, distance), 180.0)
    return match


def test_an_enemy_in_view_is_labelled_where_its_body_is() -> None:
    labels = KINDS.read(duel(), [0])[0]
    assert labels.dtype == np.uint8
    rows, columns = np.nonzero(labels == Kind.AGENT)
    # 56.3 pixels to the unit slope. Head 0.28 m above the eye, soles 1.5 m below, shoulders 0.38 m aside.
    assert (rows.min(), rows.max()) == (16, 32)
    assert 28 <= columns.min() <= 30
    assert 34 <= columns.max() <= 36
    assert labels[0].tolist() == [Kind.NOTHING] * 65
    assert labels[-1].tolist() == [Kind.TERRAIN] * 65


def test_an_enemy_behind_a_wall_is_not_seen_and_one_half_behind_it_is_half() -> None:
    whole = (KINDS.read(duel(), [0])[0] == Kind.AGENT).sum()
    behind = KINDS.read(duel(box((-5, -1, 2), (5, 5, 3))), [0])[0]
    assert not (behind == Kind.AGENT).any()
    assert (behind == Kind.WALL).any()
    half = KINDS.read(duel(box((-5, -1, 2), (0, 5, 3))), [0])[0]
    assert 0.4 * whole < (half == Kind.AGENT).sum() < 0.6 * whole


def test_a_dead_enemy_is_gone() -> None:
    match = duel()
    match.state.agents.health[0, 1] = 0
    assert not (KINDS.read(match, [0]) == Kind.AGENT).any()


@pytest.mark.parametrize("pitch", [0.0, 45.0, 90.0])
def test_ones_own_body_is_never_in_ones_own_picture(pitch: float) -> None:
    match = duel(distance=70.0)
    place(match, 0, (0, 0, 0), 180.0, pitch)
    assert not (KINDS.read(match, [0]) == Kind.AGENT).any()
    place(match, 1, (0, 0, 1.0), 180.0, 20.0)
    assert (KINDS.read(match, [1]) == Kind.AGENT).any()


def test_a_box_is_labelled_until_it_is_picked_up() -> None:
    match = duel(distance=70.0)
    place(match, 0, (0, 0, 0), 0.0, 50.0)
    supplies = match.state.supplies
    supplies.position[0, 0], supplies.quantity[0, 0], supplies.appears[0, 0] = (0, 0, 1.2), 3, 0
    assert (KINDS.read(match, [0]) == Kind.SUPPLY_BOX).any()
    act(match, seat_0={"pick_up": 1})
    place(match, 0, (0, 0, 0), 0.0, 50.0)
    assert not (KINDS.read(match, [0]) == Kind.SUPPLY_BOX).any()


def test_water_is_labelled_where_its_surface_is() -> None:
    labels = KINDS.read(duel(water=0.5), [0])[0]
    assert labels[-1].tolist() == [Kind.WATER] * 65
    assert not (labels == Kind.TERRAIN).any()


@pytest.mark.parametrize("kind", [kind for kind in Kind if Kind.WALL <= kind <= Kind.BUSH])
def test_each_kind_of_solid_is_labelled_as_itself(kind: Kind) -> None:
    labels = KINDS.read(duel(box((-1, 1, 4), (1, 2, 5), kind), distance=70.0), [0])[0]
    assert labels[18, 32] == kind


def test_instances_tell_two_agents_two_solids_and_two_boxes_apart() -> None:
    match = make_match(
        world=flat_world(80, [box((-4, 0, 8), (-3, 2, 9)), box((3, 0, 8), (4, 2, 9))]), seats=3
    )
    supplies = match.state.supplies
    supplies.quantity[:] = 0
    for slot, x in enumerate((-2.0, 2.0)):
        supplies.position[0, slot], supplies.quantity[0, slot] = (x, 0, 5), 1
        supplies.appears[0, slot], supplies.serial[0, slot] = 0, 70 + slot
    place(match, 0, (0, 0, 0))
    place(match, 1, (-0.7, 0, 6), 180.0)
    place(match, 2, (0.7, 0, 6), 180.0)
    labels = INSTANCES.read(match, [0])[0]
    assert labels.dtype == np.int32
    columns = {int(label): float(np.nonzero(labels == label)[1].mean()) for label in np.unique(labels)}
    assert sorted(columns) == [
        *(0, 1),
        *(FIRST_AGENT + 1, FIRST_AGENT + 2),
        *(FIRST_SOLID, FIRST_SOLID + 1),
        *(FIRST_BOX + 70, FIRST_BOX + 71),
    ]
    for left in (FIRST_AGENT + 1, FIRST_SOLID, FIRST_BOX + 70):
        assert columns[left] < 32 < columns[left + 1]


def test_both_labels_agree_on_what_is_there() -> None:
    match = duel(box((-4, 0, 8), (4, 2, 9)))
    kinds, instances = KINDS.read(match, [0, 1]), INSTANCES.read(match, [0, 1])
    assert ((kinds == Kind.AGENT) == ((instances >= FIRST_AGENT) & (instances < FIRST_SOLID))).all()
    assert ((kinds == Kind.WALL) == ((instances >= FIRST_SOLID) & (instances < FIRST_BOX))).all()
    assert (instances[kinds <= Kind.WATER] == kinds[kinds <= Kind.WATER]).all()


def test_an_unknown_label_is_refused() -> None:
    with pytest.raises(ValueError, match=r"label.*'kind' or 'instance'"):
        SegmentationCamera(label="colour")  # type: ignore[arg-type]

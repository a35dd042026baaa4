"""The segmentation camera labels each pixel by what is there, or by which thing it is."""

import numpy as np
import pytest
from tests.builders import box, flat_world, lay_boxes, make_match, place
from tests.engine.sensors.scenes import duel

from wildscav_engine.geometry.world import Kind
from wildscav_engine.sensors import SegmentationCamera
from wildscav_engine.sensors.optics.segmentation import FIRST_AGENT, FIRST_BOX, FIRST_SOLID

KINDS = SegmentationCamera(width=65, height=37)
INSTANCES = SegmentationCamera(width=65, height=37, label="instance")


def test_water_is_labelled_where_its_surface_is() -> None:
    assert KINDS.read(duel(), [0])[0, -1].tolist() == [Kind.TERRAIN] * 65
    labels = KINDS.read(duel(water=0.5), [0])[0]
    assert labels.dtype == np.uint8
    assert labels[0].tolist() == [Kind.NOTHING] * 65
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
    lay_boxes(match, (-2.0, 0, 5), (2.0, 0, 5), serial=70)
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

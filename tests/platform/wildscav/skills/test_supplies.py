"""The task list: which boxes are known, wanted and gone, and where to look for more."""

import numpy as np
from tests.platform.wildscav.skills.observations import match_info, seen

from wildscav import SupplyBox
from wildscav.skills.supplies import BoxMemory, Prospecting
from wildscav.skills.surroundings import Rings

BOX = SupplyBox(id=3, position=(5.0, 0.0, 0.0), quantity=10)


def test_a_box_is_remembered_out_of_sight_and_forgotten_when_taken() -> None:
    memory = BoxMemory(match_info())

    memory.update(seen(supply_boxes=(BOX,)))
    memory.update(seen(position=(40.0, 0.0, 0.0)))
    assert memory.wanted(1.0) == {3: BOX}

    memory.update(seen(position=(10.0, 0.0, 0.0)))  # near enough to see that it is gone
    assert memory.wanted(1.0) == {}


def test_a_box_that_is_left_alone_is_wanted_again_later() -> None:
    memory = BoxMemory(match_info())
    memory.update(seen(supply_boxes=(BOX,)))

    memory.leave_alone(3, until=30.0)

    assert memory.wanted(29.0) == {}
    assert memory.wanted(30.0) == {3: BOX}


def test_every_part_of_the_map_is_looked_at() -> None:
    prospecting, here, time = Prospecting(match_info()), (0.0, 0.0, 0.0), 0.0

    for _ in range(60):
        prospecting.visit(here)
        if prospecting.seen.all():
            break
        here = prospecting.next_place(seen(position=here, time=time), (0.0, 0.0))
        time += 1.0

    assert prospecting.seen.all()


def test_a_building_seen_from_afar_comes_before_empty_ground() -> None:
    prospecting = Prospecting(match_info(map_size=200.0))
    prospecting.visit((0.0, 0.0, 0.0))
    reading = np.full((31, 90), 60.0, np.float32)
    up = np.radians(np.linspace(45.0, -55.0, 31))
    reading[10:14, 20:25] = (40.0 / np.cos(up[10:14]))[:, None]  # a wall to the east, 40 m away

    prospecting.note_walls((0.0, 0.0, 0.0), 0.0, reading, Rings(60.0, -55.0, 45.0))

    place = prospecting.next_place(seen(), (0.0, 0.0))
    assert place[0] > 20.0

"""Where a body has room: it is 0.45 m in radius and 1.78 m tall, and 0.05 m stay free around it."""

import numpy as np
import pytest
from tests.builders import box, flat_world

from wildscav_engine.geometry.clearance import has_clearance, is_clear, is_free
from wildscav_engine.geometry.shapes import pitched_roof, pose
from wildscav_engine.geometry.world import Kind, convex_solid

WORLD = flat_world(
    40,
    [
        box((2, 0, -5), (3, 3, 5)),  # a wall, west side at x = 2
        box((-6, 2, -6), (-4, 2.2, -4), Kind.FLOOR),  # a slab 2 m above ground
    ],
)


@pytest.mark.parametrize(
    ("place", "clear"),
    [
        ((1.4, 0.0, 0.0), True),  # its side is 0.15 m away from the wall
        ((1.49, 0.0, 0.0), True),  # 0.06 m
        ((1.51, 0.0, 0.0), False),  # 0.04 m
        ((2.5, 0.0, 0.0), False),  # within the wall
        ((2.5, 2.94, 0.0), False),  # 0.01 m above its soles begins what stays free
        ((2.5, 2.96, 0.0), True),  # on top of the wall
        ((-5.0, 0.0, -5.0), True),  # under the slab: 1.78 + 0.05 < 2
        ((-5.0, 0.16, -5.0), True),  # 0.16 + 1.78 + 0.05 = 1.99
        ((-5.0, 0.18, -5.0), False),
        ((-5.0, 2.16, -5.0), True),  # on the slab
        ((19.9, 0.0, 19.9), True),  # the edge of the map is no wall
    ],
)
def test_a_body_is_clear_of_what_it_does_not_touch(place: tuple[float, float, float], clear: bool) -> None:
    assert is_clear(WORLD, *place) is clear


@pytest.mark.parametrize(("room", "fits"), [(0.0, True), (0.5, True), (0.54, True), (0.56, False)])
def test_room_is_measured_from_the_side_of_the_body(room: float, fits: bool) -> None:
    # 1 m from the wall to the middle of the body, 0.45 m of which are the body.
    assert has_clearance(WORLD, 1.0, 0.0, 0.0, room) is fits


def test_a_cylinder_that_only_reaches_a_box_but_no_face_is_free() -> None:
    # The roof's ridge is 3 m above its eaves, 4 m to each side: at its side the box around it is mostly air.
    roof = pitched_roof(Kind.ROOF, pose(0.0, 0.0, 0.0), (-4.0, 0.0, -4.0), (4.0, 3.0, 4.0), 0.1, (0.0, 0.0))
    world = flat_world(40, [roof])

    assert is_free(world, 3.5, 2.0, 2.5, 0.0, 0.0)  # over the eaves
    assert not is_free(world, 0.5, 2.0, 2.5, 0.0, 0.0)  # through the ridge


def test_it_is_what_a_body_of_points_finds() -> None:
    # A wall turned by 45 degrees through the origin, 1 m thick: |x - z| <= √2 / 2 for x and z near 0.
    half = np.sqrt(0.5)
    corners = [(-5 - half / 2, -5 + half / 2), (-5 + half / 2, -5 - half / 2)]
    corners += [(5 + half / 2, 5 - half / 2), (5 - half / 2, 5 + half / 2)]
    vertices = np.array([(x, y, z) for y in (0.0, 3.0) for x, z in corners])
    faces = ((0, 1, 2), (4, 5, 6), (0, 1, 4), (1, 2, 5), (2, 3, 6), (3, 0, 7))
    world = flat_world(40, [convex_solid(Kind.WALL, vertices, faces)])

    for x, z in np.random.default_rng(7).uniform(-3, 3, (200, 2)):
        away = abs(x - z) * half - 0.5  # from the wall's side to the middle of the body
        assert is_clear(world, x, 0.0, z) is bool(away > 0.45 + 0.05)

"""The heat map on the ground: where supplies lie, and nowhere else."""

import numpy as np
from tests.builders import flat_world

from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.maps import generate_map
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.view.entities.ground_overlay import LIFT, GroundOverlay
from wildscav_engine.view.entities.heat import density
from wildscav_engine.view.recording.history import Boxes


def boxes(*places: tuple[float, float, int]) -> Boxes:
    """Boxes at x, z with so many supplies each."""
    position = np.array([(x, 0.0, z) for x, z, _ in places], float).reshape(-1, 3)
    quantity = np.array([supplies for _, _, supplies in places], np.int32)
    return Boxes(0, position, quantity, np.arange(len(places), dtype=np.int32))


def test_it_is_hottest_where_most_supplies_lie() -> None:
    overlay = GroundOverlay(flat_world(size=40))
    heat = density(overlay, boxes((11.0, -9.0, 5), (-13.0, 3.0, 2)))

    north, east = np.unravel_index(heat.argmax(), heat.shape)

    assert (overlay.center_east[east], overlay.center_north[north]) == (11.0, -9.0)
    assert density(overlay, boxes()).max() == 0.0


def test_the_net_of_a_small_map_has_the_grounds_own_corners() -> None:
    world = flat_world(size=40, slope=0.5)
    overlay = GroundOverlay(world)

    assert overlay.points.shape == (21, 21, 3)
    np.testing.assert_allclose(overlay.points[..., 1], overlay.points[..., 0] * 0.5 + LIFT)


def test_the_net_lies_nowhere_under_the_ground() -> None:
    world = generate_map(MapConfig(size=100, relief=2.0, ruggedness=1.0, houses=0), 3).world
    overlay = GroundOverlay(world, max_cells=12)  # much coarser than the ground

    for x, y, z in overlay.points.reshape(-1, 3).tolist():
        for east, north in ((0.0, 0.0), (1.9, 0.0), (0.0, -1.9)):
            if abs(x + east) < 50 and abs(z + north) < 50:
                assert y > ground_at(world, x + east, z + north).height


def test_chosen_cells_are_two_triangles_each_and_none_is_one_without_area() -> None:
    overlay = GroundOverlay(flat_world(size=40))
    chosen = np.zeros((20, 20), np.bool_)
    assert overlay.triangles_of(chosen).tolist() == [[0, 0, 0]]

    chosen[3, 5] = True  # the cell from x = -10, z = -14

    corners = overlay.vertices[overlay.triangles_of(chosen)]
    assert corners.shape == (2, 3, 3)
    assert (corners[..., 0].min(), corners[..., 0].max()) == (-10.0, -8.0)
    assert (corners[..., 1].min(), corners[..., 1].max()) == (-14.0, -12.0)

"""What lies on the ground in a replay: the heat map where supplies are, and the edge of the safe zone."""

import numpy as np
from tests.builders import act, flat_world, make_match

from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.maps import generate_map
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.zone_config import ZoneConfig, ZonePhase
from wildscav_engine.view.entities.ground_overlay import (
    CORNERS,
    LIFT,
    ZONE_LIFT,
    GroundOverlay,
    density,
    ring,
    static_zone,
)
from wildscav_engine.view.events import events_of
from wildscav_engine.view.recording.history import Boxes, collect_history


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


def test_the_history_has_the_zone_of_every_step_and_the_circle_that_it_draws_in_to() -> None:
    first = ZonePhase(wait=0.5, shrink=1, share=0.5, damage=0)
    phases = (first, ZonePhase(wait=0, shrink=1, share=0, damage=0))
    match = make_match("royale", world=flat_world(), seats=2, zone=ZoneConfig(phases=phases), time_limit=3)

    def play():
        yield match
        while not match.over:
            act(match)
            yield match

    zone = collect_history(play(), 30, None)[1].zone
    assert zone is not None
    full = 20 * np.sqrt(2)
    np.testing.assert_allclose(zone[[0, 5, 10, 15, 20, 25], 2], full * np.array([1, 1, 0.75, 0.5, 0.25, 0]))
    np.testing.assert_allclose(zone[[0, 14, 15, 25], 5], [full / 2, full / 2, 0, 0])


def test_a_ring_lies_on_the_ground_and_on_the_map() -> None:
    line = ring(flat_world(size=40, slope=0.1), np.array([5.0, 0.0, 30.0]))
    assert line.shape == (CORNERS + 1, 3)
    assert np.abs(line[:, [0, 2]]).max() <= 20
    np.testing.assert_allclose(line[:, 1], line[:, 0] * 0.1 + ZONE_LIFT)


def test_the_rings_are_thin_lines_to_who_stands_at_them_too() -> None:
    phase = ZonePhase(wait=1, shrink=1, share=0.5, damage=0)
    match = make_match("royale", world=flat_world(), seats=2, zone=ZoneConfig(phases=(phase,)))
    looks = dict(static_zone(collect_history([match], 0, None)[1]))
    for path in ("zone/edge", "zone/next"):
        assert looks[path].radii.as_arrow_array()[0].as_py() < 0  # below 0: pixels in the picture, not metres


def test_who_does_not_come_back_is_out() -> None:
    match = make_match("royale", seats=3, zone=ZoneConfig())
    match.state.agents.damage[0, 1] = 1000

    def play():
        yield match
        act(match)
        yield match

    events = events_of(collect_history(play(), 1, None)[1], ("ann", "bob", "eve"))
    assert ("OUT", "bob is out") in [(event.kind, event.text) for event in events]

"""The colour camera shows what a person would see from there, enemies and boxes included."""

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.builders import act, box, flat_world, make_match, map_from, place

from wildscav_engine.geometry.world import Solid
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.palette import of_seat
from wildscav_engine.sensors import ColorCamera
from wildscav_engine.sensors.optics.dynamic_objects import dynamic_objects_of
from wildscav_engine.sensors.optics.image_sensor import ShownMaps
from wildscav_engine.simulation.match import Match

CAMERA = ColorCamera(width=64, height=36)


def duel(*solids: Solid, distance: float = 6.0) -> Match:
    """Seat 0 at the origin, looking north; seat 1 north of it, looking back."""
    match = make_match(world=flat_world(80, solids), seats=2)
    match.state.supplies.quantity[:] = 0
    match.state.agents.invincible_left[:] = 0
    place(match, 0, (0, 0, 0))
    place(match, 1, (0, 0, distance), 180.0)
    return match


def alone(match: Match, camera: ColorCamera = CAMERA) -> NDArray[np.uint8]:
    """What seat 0's picture would be if nothing moved but for its own shadow."""
    match.state.agents.health[0, 1:] = 0
    match.state.supplies.quantity[:] = 0
    return camera.read(match, [0])[0]


def changed(match: Match, camera: ColorCamera = CAMERA) -> NDArray[np.bool_]:
    """Which of seat 0's pixels show others or boxes, or their shadows."""
    seen = camera.read(match, [0])[0]
    return np.asarray((seen != alone(match, camera)).any(axis=-1))


def test_an_enemy_in_view_is_seen_in_its_colour() -> None:
    picture = CAMERA.read(duel(), [0])[0].astype(float)
    # Its torso, 1.13 m above the ground: 0.37 m below the eye, 6 m away, 41.7 rows to the unit slope.
    torso = picture[21, 31:33].mean(axis=0)
    color = np.array(of_seat(1), float)
    assert torso.argmax() == color.argmax()
    assert torso.argmin() == color.argmin()


def test_an_enemy_is_not_seen_behind_a_wall_nor_behind_ones_back() -> None:
    hidden = duel(box((-5, -1, 2), (5, 5, 3)))
    assert not changed(hidden).any()
    behind = duel()
    place(behind, 1, (0, 0, -6.0), 0.0)
    assert not changed(behind, ColorCamera(width=64, height=36, shadows=False)).any()


@pytest.mark.parametrize("pitch", [0.0, 60.0, 90.0, -90.0])
def test_ones_own_body_is_never_in_ones_own_picture(pitch: float) -> None:
    match = duel()
    camera = ColorCamera(width=64, height=36, shadows=False)
    match.state.agents.health[0, 1] = 0
    place(match, 0, (0, 0, 0), 0.0, pitch)
    mine = camera.read(match, [0])[0]
    empty = camera.render(match.game_map, [(0, 1.5, 0)], [0.0], [pitch])[0]
    assert (mine == empty).all()
    from_outside = camera.render(
        match.game_map, [(0, 1.5, -3)], [0.0], [0.0], moving=dynamic_objects_of(match), viewers=[1]
    )
    assert (from_outside != camera.render(match.game_map, [(0, 1.5, -3)], [0.0], [0.0])).any()


def test_a_box_is_seen_until_it_is_picked_up() -> None:
    match = duel(distance=70.0)
    place(match, 0, (0, 0, 0), 0.0, 50.0)
    supplies = match.state.supplies
    supplies.position[0, 0], supplies.quantity[0, 0], supplies.appears[0, 0] = (0, 0, 1.2), 3, 0
    before = CAMERA.read(match, [0])[0]
    act(match, seat_0={"pick_up": 1})
    place(match, 0, (0, 0, 0), 0.0, 50.0)
    after = CAMERA.read(match, [0])[0]
    assert (before != after).any(axis=-1).mean() > 0.1
    assert (after == alone(match)).all()


def test_what_is_beyond_far_is_not_seen() -> None:
    assert changed(duel(distance=8.0)).any()
    assert not changed(duel(distance=8.0), ColorCamera(width=64, height=36, far=7.0)).any()


def test_a_picture_shows_a_house_door_as_a_hole_in_a_wall() -> None:
    wall = [box((-10, -1, 8), (-1, 4, 8.3)), box((1, -1, 8), (10, 4, 8.3)), box((-1, 2, 8), (1, 4, 8.3))]
    picture = CAMERA.render(map_from(flat_world(80, wall)), [(0, 1.5, 0)], [0.0], [0.0])[0].astype(float)
    through, beside = picture[19:22, 31:33].mean(axis=(0, 1)), picture[19:22, 10:20].mean(axis=(0, 1))
    assert np.abs(through - beside).sum() > 60


def test_its_options_are_checked() -> None:
    assert ColorCamera().space.shape == (90, 160, 3)
    with pytest.raises(ValueError, match="shadows"):
        ColorCamera(shadows="perhaps")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="there is no option 'colour'"):
        ColorCamera(colour=True)  # type: ignore[call-arg]


def test_the_objects_of_a_state_are_made_once_and_anew_for_every_change_of_it() -> None:
    match = duel()
    supplies, agents = match.state.supplies, match.state.agents
    before = dynamic_objects_of(match)
    assert dynamic_objects_of(match) is before
    assert before.sets is before.sets
    supplies.quantity[0, 0], supplies.appears[0, 0] = 3, 0
    with_box = dynamic_objects_of(match)
    assert len(with_box.kind) > len(before.kind)
    agents.yaw[0, 1] += 90.0
    turned = dynamic_objects_of(match)
    assert (turned.faces != with_box.faces).any()
    agents.invincible_left[0, 1] = 5
    assert (dynamic_objects_of(match).color != turned.color).any()
    agents.health[0, 1] = 0
    assert len(dynamic_objects_of(match).kind) < len(turned.kind)


@pytest.mark.parametrize("size", [(9, 7), (300, 220), (640, 420)])
def test_pictures_of_matches_on_two_maps_are_those_of_each_alone(size: tuple[int, int]) -> None:
    matches = [duel(box((-5, -1, 2), (5, height, 3))) for height in (0.5, 3.0)]
    camera, every = ColorCamera(*size), [matches[0], matches[1], matches[0]]
    things = [dynamic_objects_of(match) for match in every]
    eyes, looks = np.tile([0.0, 1.5, 0.0], (3, 1)), np.zeros(3)
    alone = [
        camera.render(match.game_map, eyes[:1], [0.0], [0.0], moving=thing, viewers=[0])[0]
        for match, thing in zip(every, things, strict=True)
    ]

    together = np.empty((3, *camera.shape), np.uint8)
    maps = ShownMaps([match.game_map for match in every])
    cameras = Cameras(eyes, looks, looks, np.zeros(3, np.int32), *camera.lens)
    assert camera.render_matches_into(maps, things[0].sets, np.zeros(3, np.int64), cameras, together)

    assert together.tobytes() == np.stack(alone).tobytes()
    assert (together[0] != together[1]).any()

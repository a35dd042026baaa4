"""The colour camera shows what a person would see from there."""

import numpy as np
from tests.builders import box, flat_world, map_from
from tests.engine.sensors.scenes import duel

from wildscav_engine.rendering.palette import of_seat
from wildscav_engine.sensors import ColorCamera

CAMERA = ColorCamera(width=64, height=36)


def test_an_enemy_in_view_is_seen_in_its_colour() -> None:
    picture = CAMERA.read(duel(), [0])[0].astype(float)
    # Its torso, 1.13 m above the ground: 0.37 m below the eye, 6 m away, 41.7 rows to the unit slope.
    torso = picture[21, 31:33].mean(axis=0)
    color = np.array(of_seat(1), float)
    assert torso.argmax() == color.argmax()
    assert torso.argmin() == color.argmin()


def test_a_picture_shows_a_house_door_as_a_hole_in_a_wall() -> None:
    wall = [box((-10, -1, 8), (-1, 4, 8.3)), box((1, -1, 8), (10, 4, 8.3)), box((-1, 2, 8), (1, 4, 8.3))]
    picture = CAMERA.render(map_from(flat_world(80, wall)), [(0, 1.5, 0)], [0.0], [0.0])[0].astype(float)
    through, beside = picture[19:22, 31:33].mean(axis=(0, 1)), picture[19:22, 10:20].mean(axis=(0, 1))
    assert np.abs(through - beside).sum() > 60

"""How readings are shown: what bright and dark, and which colour, say of them."""

import numpy as np
import pytest
from tests.builders import make_match

from wildscav_engine.geometry.world import Kind
from wildscav_engine.sensors import SENSORS, ColorCamera, DepthCamera, Lidar, SegmentationCamera
from wildscav_engine.sensors.display.colors import (
    KIND_COLORS,
    distance_colors,
    label_colors,
    normal_colors,
    reading_colors,
)
from wildscav_engine.sensors.display.legend import draw_reading
from wildscav_engine.sensors.optics.image_sensor import ImageSensor

IMAGES = [kind() for kind in SENSORS.values() if issubclass(kind, ImageSensor)]


def test_near_is_bright_and_far_is_dark() -> None:
    colors = distance_colors(np.linspace(0, 80, 200)[None], 80.0)[0].astype(int)
    assert (colors[0].tolist(), colors[-1].tolist()) == ([252, 255, 164], [0, 0, 4])
    brightness = colors @ np.array([0.2126, 0.7152, 0.0722])
    assert (np.diff(brightness) < 1.0).all()
    assert (brightness[::20][1:] < brightness[::20][:-1] - 5).all()


@pytest.mark.parametrize(
    ("distance", "color"),
    [
        (0.0, (252, 255, 164)),
        (25.0, (186, 54, 85)),  # the root of a quarter is a half: the middle of nine colours
        (6.25, (249, 140, 10)),  # a quarter of the way: the third
        (100.0, (0, 0, 4)),
        (130.0, (0, 0, 4)),
    ],
)
def test_colours_of_distances_go_with_the_square_root(distance: float, color: tuple[int, int, int]) -> None:
    assert tuple(distance_colors(np.array([[distance]], np.float32), 100.0)[0, 0]) == color


@pytest.mark.parametrize(
    ("normal", "color"),
    [
        ((0, 1, 0), (128, 255, 128)),  # up is green
        ((0, 0, -1), (128, 128, 0)),  # to the south there is no blue
        ((-1, 0, 0), (0, 128, 128)),
        ((0, 0, 0), (0, 0, 0)),  # nothing was met
    ],
)
def test_colours_of_normals(normal: tuple[int, int, int], color: tuple[int, int, int]) -> None:
    assert tuple(normal_colors(np.array([[normal]], np.float32))[0, 0]) == color


def test_every_kind_has_a_colour_that_no_other_is_near_to() -> None:
    assert set(KIND_COLORS) == set(Kind)
    colors = np.array(list(KIND_COLORS.values()))
    apart = np.linalg.norm(colors[:, None] - colors[None], axis=2)
    assert apart[~np.eye(len(colors), dtype=bool)].min() > 40
    labels = np.array([list(Kind)], np.uint8)
    assert (label_colors(labels)[0] == colors).all()


def test_things_that_are_told_apart_have_colours_of_their_own() -> None:
    labels = np.arange(1_000_000, 1_000_300, dtype=np.int32).reshape(10, 30)
    colors = label_colors(labels).reshape(-1, 3)
    assert len(np.unique(colors, axis=0)) > 290
    assert (np.abs(np.diff(colors.astype(int), axis=0)).sum(axis=1) > 60).all()  # neighbours most of all
    assert (label_colors(labels[3:5, :7]) == label_colors(labels)[3:5, :7]).all()


def test_pictures_keep_their_colours() -> None:
    reading = np.arange(60, dtype=np.uint8).reshape(4, 5, 3)
    assert reading_colors(ColorCamera(5, 4), reading).tobytes() == reading.tobytes()


@pytest.mark.parametrize("sensor", IMAGES, ids=lambda sensor: sensor.name)
@pytest.mark.parametrize("legend", [True, False])
def test_every_sensor_that_makes_images_can_be_drawn(sensor: ImageSensor, legend: bool) -> None:
    (reading,) = sensor.read(make_match(), [0])
    colors = reading_colors(sensor, reading)
    assert (colors.dtype, colors.shape) == (np.uint8, (*sensor.shape[:2], 3))
    picture = np.asarray(draw_reading(sensor, reading, legend=legend))
    plain = not legend or sensor.name in ("camera", "screen")
    assert (picture.shape == colors.shape) == plain
    if not plain:  # each pixel is a block, and the legend stands beneath
        times = picture.shape[1] // colors.shape[1]
        below = picture.shape[0] - 24 * (2 if sensor.name in ("depth", "lidar") else 1)
        tall = below // colors.shape[0]
        assert (picture[:below:tall, ::times][: len(colors)] == colors).all()


def test_rings_of_a_lidar_are_drawn_as_far_apart_as_they_are() -> None:
    lidar = Lidar(16, 360, lowest=-15.0, highest=15.0)  # 2 degrees between rings, 1 between columns
    picture = draw_reading(lidar, np.ones((16, 360), np.float32))
    assert (picture.width, picture.height) == (2 * 360, 2 * 2 * 16 + 48)
    single = draw_reading(Lidar(1, 500), np.ones((1, 500), np.float32))
    assert (single.width, single.height) == (500, 1 + 48)


def test_the_scale_beneath_distances_has_the_colours_of_the_picture() -> None:
    sensor = DepthCamera(500, 10, 64.0)
    picture = np.asarray(draw_reading(sensor, np.full((10, 500), 16.0, np.float32)))
    bar = picture[10 + 12, 10:-10]
    assert (picture[0, 0] == distance_colors(np.array([[16.0]]), 64.0)).all()
    assert (bar[240] == picture[0, 0]).all(axis=-1) or np.abs(bar[240].astype(int) - picture[0, 0]).max() <= 2
    assert (bar[0].astype(int).sum(), bar[-1].astype(int).sum()) == (
        pytest.approx(671, abs=9),
        pytest.approx(4, abs=9),
    )


def test_a_legend_names_what_is_in_the_picture_and_nothing_else() -> None:
    sensor = SegmentationCamera(500, 10)
    labels = np.full((10, 500), int(Kind.TERRAIN), np.uint8)
    labels[:, :50] = Kind.WALL
    legend = np.asarray(draw_reading(sensor, labels))[10:].reshape(-1, 3)
    shown = {kind for kind in Kind if (legend == KIND_COLORS[kind]).all(axis=1).sum() >= 100}
    assert shown == {Kind.TERRAIN, Kind.WALL}

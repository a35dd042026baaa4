"""Images from any place: what is asked for is checked, and how many share the work changes nothing."""

import copy
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from numba.core.errors import NumbaError

from wildscav_engine.maps import generate_map
from wildscav_engine.parallel.turns import ALONE
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.tracing.workspace import LARGEST_CACHED
from wildscav_engine.sensors import (
    ColorCamera,
    DepthCamera,
    Lidar,
    NormalCamera,
    SegmentationCamera,
    parse_sensors,
)
from wildscav_engine.sensors.optics.dynamic_objects import placed_objects
from wildscav_engine.sensors.optics.image_sensor import (
    NO_DYNAMIC_OBJECTS,
    NO_VIEWER,
    ImageSensor,
    ShownMaps,
)
from wildscav_engine.specs.map_spec import MapConfig

COUNTRY, PLAIN = generate_map(MapConfig(size=60, houses=2), 3), generate_map(MapConfig(size=40, houses=0), 1)
FINE: dict[str, Any] = {"positions": np.ones((2, 3)), "yaws": np.zeros(2), "pitches": np.zeros(2)}


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"positions": np.zeros(3)}, r"positions are float64 of shape \(3,\), must be .* shape \(N, 3\)"),
        ({"positions": np.zeros((2, 2))}, r"positions .* shape \(2, 2\), must be"),
        ({"positions": [(0, np.nan, 0)] * 2}, "positions hold nan, must be finite"),
        ({"yaws": np.zeros(3)}, r"yaws are float64 of shape \(3,\), must be .* shape \(2,\)"),
        ({"yaws": [0, np.inf]}, "yaws hold inf, must be finite"),
        ({"pitches": ["a", "b"]}, "pitches are <U1 .* must be real numbers"),
        ({"viewers": [1]}, r"viewers .* shape \(1,\), must be .* shape \(2,\)"),
        ({"viewers": [0, -1]}, "viewers hold -1, must be seats, 0 or more"),
        ({"viewers": [0, 2**32 - 2]}, "viewers hold 4294967294, must be seats"),
        ({"threads": 0}, "threads is 0, must be at least 1"),
    ],
)
def test_what_cannot_be_looked_from_is_named_in_one_line(wrong: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said) as caught:
        DepthCamera().render(COUNTRY, **(FINE | wrong))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "sensor",
    [
        *(DepthCamera(), NormalCamera(), Lidar(azimuths=30)),
        *(ColorCamera(40, 23), ColorCamera(40, 23, quality="fast")),
    ],
)
@pytest.mark.parametrize("threads", [2, 3, 50])
def test_threads_and_batches_change_no_bit(
    sensor: ImageSensor, threads: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wildscav_engine.sensors.optics.image_sensor.MIN_THREAD_TIME", 1)
    places = [
        COUNTRY.outdoor[:: len(COUNTRY.outdoor) // 9][:4],
        COUNTRY.indoor[:: len(COUNTRY.indoor) // 4][:3],
    ]
    eyes = np.concatenate(places) + np.array((0, 1.5, 0))
    yaws, pitches = np.linspace(-170, 170, 7), np.linspace(-40, 40, 7)

    together = sensor.render(COUNTRY, eyes, yaws, pitches)
    shared = sensor.render(COUNTRY, eyes, yaws, pitches, threads=threads)

    assert shared.tobytes() == together.tobytes()
    for place in range(7):
        alone = sensor.render(COUNTRY, eyes[place : place + 1], yaws[place : place + 1], [pitches[place]])
        assert alone[0].tobytes() == together[place].tobytes()
    assert len({image.tobytes() for image in together}) == 7


def test_an_error_of_our_own_is_not_hidden_behind_a_slower_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the depth camera's short way does not take goes the long way; what it breaks on is told."""
    expected = DepthCamera(5, 4).render(COUNTRY, **FINE)
    for error in (TypeError("a bug"), ValueError("a bug"), NumbaError("a bug")):

        def trace(*_: object, error: Exception = error) -> bool:
            raise error

        monkeypatch.setattr("wildscav_engine.sensors.optics.depth.depths_tracer", lambda trace=trace: trace)
        with pytest.raises(type(error), match="a bug"):
            DepthCamera(5, 4).render(COUNTRY, **FINE)
        lists = {name: array.tolist() for name, array in FINE.items()}
        assert DepthCamera(5, 4).render(COUNTRY, **lists).tobytes() == expected.tobytes()


def test_arrays_are_looked_from_alike_however_they_lie_in_memory() -> None:
    eyes, turns = COUNTRY.outdoor[:7] + np.array((0, 1.5, 0)), np.linspace(-170, 170, 7)
    plain = DepthCamera(5, 4).render(COUNTRY, eyes, turns, np.zeros(7))
    fixed = turns.copy()
    fixed.flags.writeable = False

    strewn = DepthCamera(5, 4).render(COUNTRY, np.asfortranarray(eyes), fixed, np.zeros(14)[::2])

    assert strewn.tobytes() == plain.tobytes()


@pytest.mark.parametrize(
    "camera", [DepthCamera(9, 7), DepthCamera(LARGEST_CACHED // 256 + 2, 256)], ids=["small", "large"]
)
def test_images_of_other_sizes_and_maps_in_between_change_no_bit(camera: DepthCamera) -> None:
    """Images are made in workspaces that are kept: nothing of one is left in the next."""
    eyes, turns = COUNTRY.outdoor[:7] + np.array((0, 1.5, 0)), np.linspace(-170, 170, 7)
    once = camera.render(COUNTRY, eyes, turns, np.zeros(7)).tobytes()
    for width in range(1, 20, 3):
        DepthCamera(width, 7, far=1e3).render(COUNTRY, eyes[::-1].copy(), turns, np.zeros(7))
        replace(camera, height=camera.height - width % 5).render(PLAIN, eyes, turns, np.zeros(7))
        camera.render(PLAIN, eyes, turns, np.zeros(7))
        assert camera.render(COUNTRY, eyes, turns, np.zeros(7)).tobytes() == once
    assert camera.render(copy.deepcopy(COUNTRY), eyes, turns, np.zeros(7)).tobytes() == once


def test_nobody_to_look_gives_no_image() -> None:
    assert DepthCamera(5, 4).render(COUNTRY, np.zeros((0, 3)), [], []).shape == (0, 4, 5)


def test_a_wider_view_shows_things_smaller() -> None:
    """Depth at the edge of the image is that of the ray at half the field of view."""
    eyes, level = COUNTRY.outdoor[:1] + np.array((0, 1.5, 0)), [0.0]
    wide = DepthCamera(1001, 1, field_of_view=90).render(COUNTRY, eyes, level, level)[0, 0]
    ahead = DepthCamera(1, 1).render(COUNTRY, eyes, [45.0], level)[0, 0, 0]
    assert wide[-1] / np.cos(np.radians(45)) == pytest.approx(ahead, rel=0.02)


@pytest.mark.parametrize(
    "sensor",
    [
        *(DepthCamera(9, 7), DepthCamera(300, 220), NormalCamera(9, 7, moving=True)),
        *(SegmentationCamera(9, 7), Lidar(azimuths=30, moving=True)),
        *(ColorCamera(9, 7), ColorCamera(300, 220), ColorCamera(640, 420)),
    ],
    ids=lambda sensor: f"{sensor.name}-{sensor.shape[1]}",
)
def test_images_of_many_maps_are_those_of_each_map(sensor: ImageSensor) -> None:
    maps = [COUNTRY, PLAIN, COUNTRY, PLAIN, PLAIN]
    eyes = np.stack([game_map.outdoor[place] for place, game_map in enumerate(maps)]) + np.array((0, 1.5, 0))
    turns, level = np.linspace(-170, 170, 5), np.zeros(5)
    things = NO_DYNAMIC_OBJECTS
    if sensor.sees_objects:
        ahead = np.stack((np.sin(np.radians(turns)), level - 0.5, np.cos(np.radians(turns))), axis=1)
        things = placed_objects([(tuple(place), 0.0) for place in eyes + 3.0 * ahead], [])
    alone = [
        sensor.render(game_map, eyes[[place]], turns[[place]], [0.0], moving=things)[0]
        for place, game_map in enumerate(maps)
    ]
    assert len({image.tobytes() for image in alone}) > 3

    cameras = Cameras(eyes, turns, level, np.full(5, NO_VIEWER, np.int32), *sensor.lens)
    together = np.empty((5, *sensor.shape), sensor.dtype)

    in_turn = partial(ImageSensor.write_images, sensor)  # which paints all parts of a body alike
    for write in (sensor.render_matches_into, *[in_turn] * (not isinstance(sensor, ColorCamera))):
        together.fill(77)
        assert write(ShownMaps(maps), things.sets, np.zeros(5, np.int64), cameras, together, ALONE)
        assert together.tobytes() == np.stack(alone).tobytes()


def test_a_seat_cannot_ask_for_more_rays_than_a_match_can_wait_for() -> None:
    with pytest.raises(
        ValueError, match=r"too many rays per step \(depth 417,600, camera 384,000\).* at most 500,000"
    ):
        parse_sensors({"depth": {"width": 870, "height": 480}, "camera": {"width": 800, "height": 480}})
    assert list(parse_sensors({"depth": {"width": 380, "height": 220}, "lidar": {}})) == ["depth", "lidar"]

"""Every sensor that makes images shows the agents and boxes that can be seen from there, and no others."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.builders import act, box, lay_boxes, place
from tests.engine.sensors.scenes import duel

from wildscav_engine.sensors import ColorCamera, DepthCamera, Lidar, NormalCamera, SegmentationCamera
from wildscav_engine.sensors.optics.image_sensor import ImageSensor
from wildscav_engine.simulation.match import Match

SIZE: dict[str, Any] = {"width": 65, "height": 37, "far": 7.0}
LIDAR = Lidar(8, range=7.0, lowest=-60.0, moving=True)
SENSORS: list[ImageSensor] = [
    DepthCamera(**SIZE, moving=True),
    NormalCamera(**SIZE, moving=True),
    SegmentationCamera(**SIZE),
    SegmentationCamera(**SIZE, label="instance"),
    ColorCamera(**SIZE, shadows=False),
    ColorCamera(**SIZE, shadows=False, quality="fast"),
    LIDAR,
]
every_sensor = pytest.mark.parametrize("sensor", SENSORS, ids=lambda sensor: sensor.name)


def shown(sensor: ImageSensor, match: Match) -> NDArray[np.bool_]:
    """Which of seat 0's pixels show anything but the map."""
    agents = match.state.agents
    eye, yaw, pitch = agents.position[0, :1] + (0, 1.5, 0), agents.yaw[0, :1], agents.pitch[0, :1]
    differs = sensor.read(match, [0])[0] != sensor.render(match.game_map, eye, yaw, pitch)[0]
    return np.asarray(differs.reshape(*sensor.shape[:2], -1).any(axis=-1))


@every_sensor
@pytest.mark.parametrize(
    ("scene", "is_seen"),
    [
        ({}, True),
        ({"distance": 8.0}, False),  # out of range
        ({"wall": True}, False),  # behind a wall
        ({"distance": -6.0}, None),  # behind one's back, which only a LIDAR sees
        ({"health": 0}, False),  # dead
    ],
)
def test_an_enemy_is_seen(sensor: ImageSensor, scene: dict[str, Any], is_seen: bool | None) -> None:
    wall = [box((-5, -1, 2), (5, 5, 3))] if "wall" in scene else []
    match = duel(*wall, distance=scene.get("distance", 6.0))
    match.state.agents.health[0, 1] = scene.get("health", 100)
    assert shown(sensor, match).any() == (sensor is LIDAR if is_seen is None else is_seen)


@every_sensor
@pytest.mark.parametrize("pitch", [0.0, 60.0, 90.0, -90.0])
def test_ones_own_body_is_never_in_ones_own_picture(sensor: ImageSensor, pitch: float) -> None:
    match = duel(distance=30.0)
    match.state.agents.pitch[0, 0] = pitch
    assert not shown(sensor, match).any()


@every_sensor
def test_a_box_is_seen_until_it_is_picked_up(sensor: ImageSensor) -> None:
    match = duel(distance=30.0)
    lay_boxes(match, (0, 0, 1.2))
    place(match, 0, (0, 0, 0), 0.0, 50.0)
    assert shown(sensor, match).any()
    act(match, seat_0={"pick_up": 1})
    place(match, 0, (0, 0, 0), 0.0, 50.0)
    assert not shown(sensor, match).any()


@pytest.mark.parametrize("sensor", [DepthCamera(), NormalCamera(), Lidar()], ids=lambda sensor: sensor.name)
def test_nothing_that_moves_is_seen_unless_it_is_asked_for(sensor: ImageSensor) -> None:
    assert not shown(sensor, duel()).any()


def test_a_lidar_meets_an_enemy_where_it_is() -> None:
    match = duel()
    place(match, 1, (-5, 0, 0), yaw=90)  # to the left
    ring = Lidar(1, lowest=0.0, highest=0.0, moving=True).read(match, [0])[0, 0]
    assert int(ring.argmin()) == pytest.approx(270, abs=3)
    assert 4.5 < ring.min() < 5.0
    assert (np.delete(ring, slice(265, 276)) == 100).all()


def test_an_enemy_is_labelled_where_its_body_is_and_half_of_it_behind_half_a_wall() -> None:
    camera = SegmentationCamera(65, 37)
    whole = shown(camera, duel())
    rows, columns = np.nonzero(whole)
    # 56.3 pixels to the unit slope. Head 0.28 m above the eye, soles 1.5 m below, shoulders 0.38 m aside.
    assert (rows.min(), rows.max()) == (16, 32)
    assert 28 <= columns.min() <= 30
    assert 34 <= columns.max() <= 36
    half = shown(camera, duel(box((-5, -1, 2), (0, 5, 3))))
    assert 0.4 * whole.sum() < half.sum() < 0.6 * whole.sum()

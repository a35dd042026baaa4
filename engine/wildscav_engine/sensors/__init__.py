"""The sensors of agents: images in ``optics`` and ``screen``, numbers in ``state``; see ``extensions.py``.

A sensor's options, with their ranges, are the fields of its class, in the files imported below.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

from wildscav_engine.extensions import Registry
from wildscav_engine.sensors.base import Sensor
from wildscav_engine.sensors.optics.camera import ColorCamera
from wildscav_engine.sensors.optics.depth import DepthCamera
from wildscav_engine.sensors.optics.image_sensor import ImageSensor
from wildscav_engine.sensors.optics.lidar import Lidar
from wildscav_engine.sensors.optics.normals import NormalCamera
from wildscav_engine.sensors.optics.segmentation import SegmentationCamera
from wildscav_engine.sensors.screen.screen import Screen
from wildscav_engine.sensors.state.agents import Teammates, VisibleAgents
from wildscav_engine.sensors.state.places import Compass, HotSpotSensor, ToHotSpot, ToWaves
from wildscav_engine.sensors.state.safe_zone import SafeZone
from wildscav_engine.sensors.state.sights import Sights
from wildscav_engine.sensors.state.supplies import NearbySupplies, ToSupplies
from wildscav_engine.specs.rules import Rules, Senses

SENSORS: Registry[type[Sensor]] = Registry("wildscav.sensors")

__all__ = [
    "SENSORS",
    "ColorCamera",
    "Compass",
    "DepthCamera",
    "HotSpotSensor",
    "Lidar",
    "NearbySupplies",
    "NormalCamera",
    "SafeZone",
    "Screen",
    "SegmentationCamera",
    "Sensor",
    "Sights",
    "Teammates",
    "ToHotSpot",
    "ToSupplies",
    "ToWaves",
    "VisibleAgents",
    "allowed_sensors",
    "parse_sensor",
    "parse_sensors",
]

MAX_RAYS = 500_000  # of all sensors of a seat in one step, because the match waits for them


def parse_sensor(name: str, options: Mapping[str, object]) -> Sensor:
    """Return a sensor with the options that ``submission.toml`` gives it.

    Raises:
        ValueError: There is no such sensor, it has no such option, or the option's value is not allowed. The
            message is one line that says what is wrong and what is allowed.
    """
    if name not in SENSORS:
        raise ValueError(f"there is no sensor {name!r}; the sensors are {', '.join(SENSORS)}")
    return SENSORS[name](**options)


def parse_sensors(wanted: Mapping[str, Mapping[str, object]]) -> dict[str, Sensor]:
    """Return all sensors of a seat, by name.

    Raises:
        ValueError: A sensor is invalid, as in ``parse_sensor``, or the sensors need too many rays together.
    """
    sensors = {name: parse_sensor(name, options) for name, options in wanted.items()}
    rays = {name: sensor.rays for name, sensor in sensors.items() if sensor.rays}
    if sum(rays.values()) > MAX_RAYS:
        parts = ", ".join(f"{name} {count:,}" for name, count in rays.items())
        raise ValueError(f"the sensors take too many rays per step ({parts}); together at most {MAX_RAYS:,}")
    return sensors


def allowed_sensors(sensors: Mapping[str, Sensor], rules: Rules) -> dict[str, Sensor]:
    """Return the sensors of a seat as the rule ``senses`` allows them.

    Unless it is ``original``, images that show agents and boxes are no wider than the rule ``view_angle``,
    and a LIDAR, which sees all around, shows none. Lists need no change: ``visibility.py`` fills them.
    """
    if rules.senses == Senses.ORIGINAL:
        return dict(sensors)
    return {name: _narrowed(sensor, rules.view_angle) for name, sensor in sensors.items()}


@lru_cache(maxsize=256)
def _narrowed(sensor: Sensor, view_angle: float) -> Sensor:
    """Return a sensor that shows agents and boxes in view alone: the same one each time, with its rays."""
    if not isinstance(sensor, ImageSensor) or not sensor.sees_objects:
        return sensor
    if isinstance(sensor, Lidar):
        return replace(sensor, moving=False)
    if getattr(sensor, "field_of_view", 0.0) <= view_angle:
        return sensor
    image: Any = sensor
    narrowed: Sensor = replace(image, field_of_view=view_angle)
    return narrowed

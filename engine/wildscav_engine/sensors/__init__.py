"""The sensors of agents: images in ``optics``, numbers in ``state``. ``extensions.py`` lists them."""

from collections.abc import Mapping
from dataclasses import replace

from wildscav_engine.extensions import Registry
from wildscav_engine.sensors.base import Sensor
from wildscav_engine.sensors.optics.camera import ColorCamera
from wildscav_engine.sensors.optics.depth import DepthCamera
from wildscav_engine.sensors.optics.lidar import Lidar
from wildscav_engine.sensors.optics.normals import NormalCamera
from wildscav_engine.sensors.optics.segmentation import SegmentationCamera
from wildscav_engine.sensors.state.agents import Teammates, VisibleAgents
from wildscav_engine.sensors.state.places import Compass, HotSpotSensor, ToHotSpot, ToWaves
from wildscav_engine.sensors.state.safe_zone import SafeZone
from wildscav_engine.sensors.state.sights import Sights
from wildscav_engine.sensors.state.supplies import NearbySupplies, ToSupplies
from wildscav_engine.specs.rules import Senses

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


def allowed_sensors(sensors: Mapping[str, Sensor], senses: int) -> dict[str, Sensor]:
    """Return the sensors of a seat as the rule ``senses`` allows them.

    A LIDAR sees all around, so it shows agents and boxes only with the original senses. Lists need no change:
    they contain what ``visibility.py`` finds in sight.
    """
    return {
        name: replace(sensor, moving=False)
        if isinstance(sensor, Lidar) and senses != Senses.ORIGINAL
        else sensor
        for name, sensor in sensors.items()
    }

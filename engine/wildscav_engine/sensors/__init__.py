"""The sensors of agents: images in ``optics``, numbers in ``state``. ``extensions.py`` lists them."""

from collections.abc import Mapping

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

"""What an agent perceives: one file and one registry line a sensor."""

from collections.abc import Mapping

from wildscav_engine.sensors.base import Sensor
from wildscav_engine.sensors.depth import DepthCamera

SENSORS: dict[str, type[Sensor]] = {
    "depth": DepthCamera,
}

__all__ = ["SENSORS", "DepthCamera", "Sensor", "parse_sensor"]


def parse_sensor(name: str, options: Mapping[str, object]) -> Sensor:
    """Return a sensor with its options as they stand in ``submission.toml``.

    Raises:
        ValueError: There is no such sensor, or it has no such option, or the option's value is not allowed;
            one line that says what is wrong and what is allowed.
    """
    if name not in SENSORS:
        raise ValueError(f"there is no sensor {name!r}; the sensors are {', '.join(SENSORS)}")
    return SENSORS[name](**options)

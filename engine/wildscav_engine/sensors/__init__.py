"""What an agent perceives: one file and one registry line a sensor."""

from wildscav_engine.sensors.base import Sensor, SensorConfig
from wildscav_engine.sensors.depth import DepthSensor

SENSORS: dict[str, Sensor] = {
    "depth": DepthSensor(),
}

__all__ = ["SENSORS", "Sensor", "SensorConfig"]

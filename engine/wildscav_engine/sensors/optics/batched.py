"""The former base class of sensors that make the images of many matches in one call."""

from wildscav_engine.sensors.optics.image_sensor import ImageSensor


class BatchedOpticalSensor(ImageSensor):
    """The same as ``ImageSensor``, for packages that name this class."""

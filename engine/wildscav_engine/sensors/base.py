"""What every sensor is, and how its options are read."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, ValidationError

from wildscav_engine.spec import one_line

if TYPE_CHECKING:
    from wildscav_engine.match import Match


class SensorConfig(BaseModel):
    """Base of the sensors' configs."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


Config = TypeVar("Config", bound=SensorConfig)


class Sensor(Protocol):
    """A way to perceive: reads an array a seat from a match."""

    name: str
    title: str
    dtype: np.dtype[np.generic]

    def parse(self, options: Mapping[str, object]) -> SensorConfig:
        """Check options as they stand in ``submission.toml``; a ValueError says in one line what is wrong."""
        ...

    def shape(self, config: SensorConfig) -> tuple[int, ...]:
        """Return the shape of one seat's reading."""
        ...

    def read(self, match: "Match", seats: Sequence[int], config: SensorConfig) -> NDArray[Any]:
        """Return the readings of some seats, (len(seats), *shape)."""
        ...


def parse_options(model: type[Config], sensor: str, options: Mapping[str, object]) -> Config:
    """Check a sensor's options.

    Raises:
        ValueError: One line with the option, what is wrong and what is allowed.
    """
    try:
        return model.model_validate(dict(options))
    except ValidationError as error:
        allowed = ", ".join(model.model_fields)
        raise ValueError(f"sensor {sensor}: {one_line(error)} (its options are {allowed})") from None

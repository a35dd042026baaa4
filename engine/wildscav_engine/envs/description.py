"""The layout of an environment's observations and actions as data, for agents without the engine.

``wildscav.policy`` reads this description. Tests ensure that its arrays equal those of the environments, bit
for bit.
"""

import dataclasses
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.spaces.actions import action_mode
from wildscav_engine.envs.spaces.columns import groups_of
from wildscav_engine.envs.spaces.flattening import scales_of
from wildscav_engine.envs.spaces.observation import readings_space
from wildscav_engine.sensors import Sensor

FORMAT = 1  # raised when older readers would misread a description


def describe(config: EnvConfig) -> dict[str, Any]:
    """Return the layout of an environment's observations and actions, ready for JSON.

    Args:
        config: The options, which are the attribute ``config`` of any environment.

    Returns:
        ``format``; ``track``; ``frames_per_action``; ``flat``; ``observations``, the parts of an observation
        in the order of flat rows, each with its name, shape, dtype, scale (the divisors of its numbers in
        flat rows), and the columns of a group or the options of a sensor; and ``actions``, as returned by
        ``ActionMode.describe``.

    Raises:
        ValueError: There are observers, which agents without the engine cannot have.
    """
    if config.observers:
        raise ValueError(f"the observers {', '.join(config.observers)} need the engine: an agent has none")
    sensors = config.read_sensors()
    columns = {
        group.name: [column.name for column in group.columns] for group in groups_of(config.version).values()
    }
    parts: list[dict[str, Any]] = []
    spaces: dict[str, Any] = dict(readings_space(config).spaces)
    for name, box in spaces.items():
        scale = _scale(name, box, config.version)
        part = {"name": name, "shape": list(box.shape), "dtype": box.dtype.str, "scale": scale}
        if name in sensors:
            parts.append(part | {"sensor": options_of(sensors[name])})
        else:
            parts.append(part | {"columns": columns[name]})
    return {
        "format": FORMAT,
        "track": config.track,
        "frames_per_action": config.frames_per_action,
        "flat": config.flat,
        "observations": parts,
        "actions": action_mode(config).describe(),
    }


def options_of(sensor: Sensor) -> dict[str, Any]:
    """Return all options of a sensor, as in ``submission.toml``."""
    fields: Any = sensor
    return {field.name: getattr(sensor, field.name) for field in dataclasses.fields(fields)}


def _scale(name: str, box: Box, version: int) -> Any:
    """Return the divisors of numbers, in the smallest shape that broadcasts."""
    scales: NDArray[np.float64] = scales_of(name, box, version).reshape(box.shape)
    while scales.ndim and (scales == scales[:1]).all():
        scales = scales[0]
    return scales.tolist()

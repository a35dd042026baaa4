"""The action modes, which convert the actions of learners to the rows of numbers that the engine plays.

- ``dict``: the paper's action space, by the names of the fields of ``actions.Field``.
- ``box``: numbers in [-1, 1]: walk east and walk north (length 1 is full speed), turn and look (1 is
  45 and 20 degrees per step), then jump and the track's other flags, which are set above 0.
- ``baseline``: one number, as in the public baselines: a compass direction, a speed, and whether to pick up.
- ``multidiscrete``: a few choices per field; directions are clockwise from the view.
- ``fine``: the same with more turns and looks, for aiming.
"""

from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.spaces.action_mode import ActionError, ActionMode
from wildscav_engine.envs.spaces.box_mode import BoxMode
from wildscav_engine.envs.spaces.choice_modes import BaselineMode, FineMode, MultiDiscreteMode
from wildscav_engine.envs.spaces.dict_mode import DictMode

__all__ = ["MODES", "ActionError", "ActionMode", "action_mode"]

MODES: dict[str, type[ActionMode]] = {
    "dict": DictMode,
    "box": BoxMode,
    "baseline": BaselineMode,
    "multidiscrete": MultiDiscreteMode,
    "fine": FineMode,
}


def action_mode(config: EnvConfig) -> ActionMode:
    """Return the action mode of an environment."""
    return MODES[config.action_mode](config.fields, config.frames_per_action)

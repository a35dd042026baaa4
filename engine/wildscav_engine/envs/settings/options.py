"""The options of environments as keyword arguments, for editors and type checkers.

The fields are those of ``EnvConfig``, which validates them and defines their defaults. A test ensures that
the names are equal.
"""

from collections.abc import Mapping, Sequence
from typing import Any, TypedDict

from wildscav_engine.envs.registry import Version
from wildscav_engine.envs.settings.config import RenderMode, RenderView
from wildscav_engine.envs.settings.functions import Observer, RewardFunction
from wildscav_engine.envs.settings.players import ActionMode, Player, Policy, Sampler, StatefulPolicy
from wildscav_engine.maps.levels import Level
from wildscav_engine.maps.pools import Split
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import Position
from wildscav_engine.specs.rules import Rules, RulesName
from wildscav_engine.specs.supply_config import SupplyConfig
from wildscav_engine.specs.zone_config import ZoneConfig

Entry = Player | Policy | StatefulPolicy | Sampler  # what fills a seat; see ``settings/players.py``
Table = Mapping[str, Any]  # fields of a spec by name that differ from their defaults


class EpisodeOptions(TypedDict, total=False):
    """The options that an environment can change between episodes; see ``config.CHANGEABLE``."""

    map: int | Sequence[int] | MapSpec | MapConfig | None
    level: Level
    split: Split
    random_maps: int
    unseen: bool
    start: Position | None
    starts: Sequence[Position | None] | None
    start_range: float | None
    target: Position | None
    time_limit: float | None
    supplies: SupplyConfig | Table | None
    supply_goal: int | None
    zone: ZoneConfig | Table | None
    rewards: Mapping[str, float] | None


class EnvOptions(EpisodeOptions, total=False):
    """The options of an environment besides its track: these and ``EpisodeOptions``. All are optional."""

    preset: str | None  # a preset to start from, a name in ``PRESETS``, or of a ladder
    # Seats:
    agents: int
    teammates: Sequence[Entry]
    opponents: Sequence[Entry] | None
    teams: Sequence[int] | None
    # Duration and rules:
    frames_per_action: int
    rules: Rules | RulesName | Table
    # Observations, actions and rewards:
    version: Version
    sensors: Mapping[str, Table] | None
    observers: Mapping[str, Observer]
    reward_functions: Mapping[str, RewardFunction]
    action_mode: ActionMode
    flat: bool
    all_metrics: bool
    # Rendering and execution:
    render_mode: RenderMode | None
    render_view: RenderView
    render_size: tuple[int, int] | None
    threads: int

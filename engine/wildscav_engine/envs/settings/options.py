"""The options of environments as keyword arguments, so that editors and type checkers know them.

The fields are those of ``EnvConfig``, which checks their values and has their defaults; a test holds the
names equal.
"""

from collections.abc import Mapping, Sequence
from typing import Any, TypedDict

from wildscav_engine.envs.settings.config import ActionMode, RenderMode, RenderView
from wildscav_engine.maps.pools import Level, Split
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import Position
from wildscav_engine.specs.rules import Rules
from wildscav_engine.specs.supply_config import SupplyConfig
from wildscav_engine.specs.zone_config import ZoneConfig

Table = Mapping[str, Any]  # the fields of a spec by name, those that differ from their defaults


class EnvOptions(TypedDict, total=False):
    """What an environment takes besides its track; all of it may be left out."""

    preset: str | None  # a set-up to start from, a name in ``PRESETS``
    # Where
    map: int | Sequence[int] | MapSpec | MapConfig | None
    level: Level
    split: Split
    random_maps: int
    start: Position | None
    starts: Sequence[Position | None] | None
    start_range: float | None
    target: Position | None
    # Who
    agents: int
    teammates: Sequence[str]
    opponents: Sequence[str] | None
    teams: Sequence[int] | None
    # How long, and by which rules
    time_limit: float | None
    frames_per_action: int
    rules: Rules | Table
    supplies: SupplyConfig | Table | None
    supply_goal: int | None
    zone: ZoneConfig | Table | None
    # What is seen, done and paid
    sensors: Mapping[str, Table] | None
    rewards: Mapping[str, float] | None
    action_mode: ActionMode
    flat: bool
    # What is shown, and how it is run
    render_mode: RenderMode | None
    render_view: RenderView
    render_size: tuple[int, int]
    threads: int

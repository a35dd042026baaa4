"""Translation of a ``GMCommand`` into the engine's spec of a match.

A scalar that the client does not send has the original's default. A number out of range is clamped, with a
warning in the log, because the client accepts wider ranges than the engine and cannot be sent an error. A
number that cannot be clamped, such as the id of a map, is refused; the error names the protocol's field.
"""

import logging
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from wildscav.errors import WildscavError
from wildscav_legacy.commander_pb2 import AgentSetup, GameMode, GMCommand, SupplyRefreshData, Vector3

if TYPE_CHECKING:
    from wildscav_engine.specs.match_spec import Equipment, MatchSpec, Position
    from wildscav_engine.specs.rules import Rules
    from wildscav_engine.specs.supply_config import SupplyConfig, SupplyWave

_Source = GMCommand | SupplyRefreshData | AgentSetup

TRACKS = {
    GameMode.NAVIGATION_MODE: "navigation",
    GameMode.SUP_GATHER_MODE: "gathering",
    GameMode.SUP_BATTLE_MODE: "battle",
}
MODES = {track: mode for mode, track in TRACKS.items()}
FRAMES_PER_ACTION = 5
SHORTEST_TIME = 0.02  # s: a frame
FARTHEST = 1000.0  # m from the middle of the largest map to its edges
IDENTIFIERS = {"game_mode", "map_id"}  # fields that cannot be clamped

log = logging.getLogger("wildscav_legacy")
MAX_AGENTS = 1000


class Number(NamedTuple):
    """A numeric field of the protocol: its default if it is not sent, and its range."""

    default: float
    least: float
    most: float


# The original game's defaults; where they are not known, the values that its client sends by default.
FIELDS = {
    "timeout": Number(60, 1, 86_400),  # s
    "game_mode": Number(GameMode.NAVIGATION_MODE, min(TRACKS), max(TRACKS)),  # navigation, gathering, battle
    "map_id": Number(1, 1, 999),  # of a numbered map
    "random_seed": Number(0, -(2**31), 2**31 - 1),
    "trigger_range": Number(1.0, 0.01, 20.0),  # m
    "supply_heatmap_radius": Number(50, 1, 1000),  # m
    "supply_create_percent": Number(50, 0, 50),  # % outdoors
    "supply_house_create_percent": Number(50, 0, 100),  # % indoors
    "supply_grid_length": Number(3, 1, 100),  # m
    "supply_random_min": Number(1, 1, 1000),  # in a box outdoors
    "supply_random_max": Number(1, 1, 1000),  # in a box outdoors
    "supply_house_random_min": Number(10, 1, 1000),  # in a box indoors
    "supply_house_random_max": Number(10, 1, 1000),  # in a box indoors
    "supply_refresh_time": Number(0, 0, 86_400),  # s
    "respawn_time": Number(10, 0, 600),  # s
    "invincible_time": Number(10, 0, 600),  # s
    "supply_loss_percent_when_dead": Number(50, 0, 100),  # %
    "water_speed_decay": Number(0.5, 0.01, 1.0),
    "hp": Number(100, 1, 10_000),  # of each agent
    "num_pack_ammo": Number(60, 0, 100_000),
    "gun_capacity": Number(15, 0, 1000),
    "attack_power": Number(20, 0, 10_000),  # hp a hit
}


class RefusedEpisodeError(WildscavError):
    """An episode cannot be played as requested; the message names the field and what is allowed."""


class Episode(NamedTuple):
    """An episode as the client requests it."""

    map_id: int
    spec: "MatchSpec"  # with starts and target as requested, which may not be usable places
    ids: tuple[int, ...]  # the client's id of each seat
    names: tuple[str, ...]  # of the seats
    is_recorded: bool
    suffix: str  # of the record's name
    has_events: bool
    seats: dict[int, int]  # of each id


def read_episode(command: GMCommand) -> Episode:
    """Return the episode that a command requests, or raise a RefusedEpisodeError."""
    setups = _setups(command)
    return Episode(
        map_id=_value(command, "map_id"),
        spec=_spec(command, setups),
        ids=tuple(setup.id for setup in setups),
        names=tuple(setup.agent_name or f"agent_{setup.id}" for setup in setups),
        is_recorded=command.is_record,
        suffix=command.replay_suffix,
        has_events=command.is_Open_Event,
        seats={setup.id: seat for seat, setup in enumerate(setups)},
    )


def _setups(command: GMCommand) -> list[AgentSetup]:
    """Return the set-up of each agent; agents that are counted but not described get the defaults."""
    setups = list(command.agent_setups)
    count = command.num_agents if command.HasField("num_agents") else len(setups)
    if not max(1, len(setups)) <= count <= MAX_AGENTS:
        raise RefusedEpisodeError(
            f"num_agents is {count}, must be {max(1, len(setups))} to {MAX_AGENTS}: "
            f"there are {len(setups)} agent_setups"
        )
    ids = {setup.id for setup in setups}
    if len(ids) < len(setups):
        raise RefusedEpisodeError(
            f"agent_setups has the ids {[setup.id for setup in setups]}: they must differ"
        )
    free = (number for number in range(count) if number not in ids)
    return setups + [
        AgentSetup(id=number) for number, _ in zip(free, range(len(setups), count), strict=False)
    ]


def _spec(command: GMCommand, setups: Sequence[AgentSetup]) -> "MatchSpec":
    from wildscav_engine.maps import map_spec
    from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
    from wildscav_engine.tracks import TRACKS as ENGINE_TRACKS

    track = TRACKS[_value(command, "game_mode")]
    has_supplies, has_target = ENGINE_TRACKS[track].has_supplies, ENGINE_TRACKS[track].has_target
    return MatchSpec(
        track=track,
        map=map_spec(_value(command, "map_id")),
        seed=_value(command, "random_seed") & 0xFFFFFFFF,
        seats=(SUBMISSION,) * len(setups),
        time_limit=_value(command, "timeout"),
        frames_per_action=FRAMES_PER_ACTION,
        starts=tuple(_place(setup, "start_location") for setup in setups),
        target=_place(command, "target_location") if has_target else None,
        supplies=_supplies(command) if has_supplies else None,
        equipment=tuple(map(_equipment, setups)),
        respawn_at="random" if command.is_random_respawn_location else "start",
        rules=_rules(command),
    )


def _rules(command: GMCommand) -> "Rules":
    from wildscav_engine.specs.rules import Rules

    return Rules(
        water_speed_factor=_value(command, "water_speed_decay"),
        respawn_time=max(SHORTEST_TIME, _value(command, "respawn_time")),
        invincible_time=_value(command, "invincible_time"),
        supply_loss=_value(command, "supply_loss_percent_when_dead") / 100,
        target_distance=_value(command, "trigger_range"),
    )


def _equipment(setup: AgentSetup) -> "Equipment":
    from wildscav_engine.specs.match_spec import Equipment

    return Equipment(
        health=_value(setup, "hp"),
        clip_size=_value(setup, "gun_capacity"),
        spare_ammo=_value(setup, "num_pack_ammo"),
        shot_damage=_value(setup, "attack_power"),
    )


def _supplies(command: GMCommand) -> "SupplyConfig":
    from wildscav_engine.specs.supply_config import SupplyConfig

    later = (_wave(data, _value(data, "supply_refresh_time")) for data in command.supply_refresh_datas)
    return SupplyConfig(
        waves=(_wave(command, 0.0), *later),
        spacing=_value(command, "supply_grid_length"),
        outdoor_quantity=_range(command, "supply_random_min", "supply_random_max"),
        indoor_quantity=_range(command, "supply_house_random_min", "supply_house_random_max"),
    )


def _wave(source: GMCommand | SupplyRefreshData, time: float) -> "SupplyWave":
    from wildscav_engine.specs.supply_config import SupplyWave

    center = _place(source, "supply_heatmap_center") or (0.0, 0.0, 0.0)
    return SupplyWave(
        time=time,
        center=(center[0], center[2]),
        radius=_value(source, "supply_heatmap_radius"),
        outdoor_richness=_value(source, "supply_create_percent"),
        indoor_richness=_value(source, "supply_house_create_percent"),
    )


def _range(command: GMCommand, least: str, most: str) -> tuple[int, int]:
    low, high = _value(command, least), _value(command, most)
    if low > high:
        log.warning("%s is %d and %s is %d: they are swapped", least, low, most, high)
    return min(low, high), max(low, high)


def _value(source: _Source, name: str) -> Any:
    """Return the number in a field, clamped to its range, or its default."""
    field = FIELDS[name]
    value = getattr(source, name) if source.HasField(name) else field.default
    value = round(value, 6) if isinstance(value, float) else value  # undoes the rounding to 32 bits
    if field.least <= value <= field.most:  # False for NaN
        return value
    problem = f"{_named(source, name)} is {value}, must be {field.least} to {field.most}"
    if name in IDENTIFIERS:
        raise RefusedEpisodeError(problem)
    used = field.default if math.isnan(value) else min(max(value, field.least), field.most)
    log.warning("%s: %s is used", problem, used)
    return used


def _place(source: _Source, name: str) -> "Position | None":
    """Return a place in m, or None if it is not sent; NaN becomes 0, and infinity a place far away."""
    if not source.HasField(name):
        return None
    vector: Vector3 = getattr(source, name)
    place = (float(vector.x), float(vector.y), float(vector.z))
    if all(map(math.isfinite, place)):
        return place
    x, y, z = (_finite(number) for number in place)
    log.warning("%s is %s, must be finite: %s is used", _named(source, name), place, (x, y, z))
    return x, y, z


def _finite(number: float) -> float:
    if math.isnan(number):
        return 0.0
    return number if math.isfinite(number) else math.copysign(FARTHEST, number)


def _named(source: _Source, name: str) -> str:
    return f"{name} of agent {source.id}" if isinstance(source, AgentSetup) else name

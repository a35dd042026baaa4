"""Setups by name: those of the paper's experiments, and the ladders of gathering and battle.

A ladder says who else plays on each level, on ground of one kind. The ladders are frozen, like the levels of
maps: a result on a level can be compared with any other on it. The country and the supplies are the same on
all levels, much like those of the suites "wild" and "fair". From level to level of the second versions, a
policy that has learned on each falls by at most a quarter of what "homing" carries on the first.
"""

from typing import Any

from wildscav_engine.maps.levels import Level
from wildscav_engine.simulation.track import PAPER_DEPTH, SUPPLIES_SEEN
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.rules import NAMED
from wildscav_engine.specs.supply_config import HotSpot, SupplyConfig, SupplyWave

# An action lasts 15 frames: 120 s are the paper's 400 actions in navigation and capture, 180 s its 600 in
# gathering.
PAPER: dict[str, Any] = {
    "map": 101,
    "time_limit": 120.0,
    "frames_per_action": 15,
    "action_mode": "baseline",
    "sensors": PAPER_DEPTH,
    "rewards": {"target_reached": 1.0},
}
GATHERING: dict[str, Any] = {
    "agents": 4,
    "teams": (0, 0, 0, 0),
    "time_limit": 180.0,
    "sensors": PAPER_DEPTH | SUPPLIES_SEEN,
    "rewards": {"supply_found": 1.0},
}
PRESETS: dict[str, tuple[str, dict[str, Any]]] = {
    "paper-navigation": ("navigation", PAPER | {"map": 103}),
    "paper-gathering": ("gathering", PAPER | GATHERING),
    "paper-capture": ("capture", PAPER | {"agents": 4}),
}

GROUND = MapConfig(size=140, houses=4, storeys=(1, 2), relief=0.8, ruggedness=0.4, water=0.0, vegetation=0.4)
COMMON: dict[str, Any] = {
    "map": GROUND,
    "agents": 1,
    "time_limit": 120.0,
    "supplies": SupplyConfig(
        waves=(SupplyWave(center=(0.0, 0.0), radius=60.0, outdoor_richness=4.0, indoor_richness=5.0),),
        spacing=5.0,
        outdoor_quantity=(1, 3),
        hot_spot=HotSpot(interval=20.0, places=6, radius=6.0, boxes=12, quantity=(10, 30)),
    ),
}
# A death costs a quarter of what is carried, and a kill counts as much as a good box.
BATTLE_RULES = NAMED["fair"]._replace(
    spare_ammo=300, respawn_time=15.0, invincible_time=2.0, supply_loss=0.25, bounty=20
)
BATTLE: dict[str, Any] = {**COMMON, "rules": BATTLE_RULES}
# How many robots of which kinds play.
COMPANY: dict[str, dict[Level, dict[str, int]]] = {
    "ladder-gathering": {
        "easy": {},
        "normal": {"gatherer-easy": 3},
        "hard": {"gatherer-easy": 9},
        "tough": {"gatherer-easy": 7, "gatherer": 2},
        "severe": {"gatherer-easy": 4, "gatherer": 5},
        "brutal": {"gatherer": 12},
        "extreme": {"gatherer-hard": 13},
        "expert": {"gatherer-hard": 29},
    },
    "ladder-battle": {
        "easy": {"gatherer-easy": 9},
        "normal": {"gatherer-easy": 8, "fighter-easy": 1},
        "hard": {"gatherer-easy": 6, "fighter-easy": 3},
        "tough": {"gatherer-easy": 3, "fighter-easy": 6},
        "severe": {"fighter-easy": 9},
        "brutal": {"fighter": 9},
        "extreme": {"fighter": 4, "fighter-hard": 5},
        "expert": {"fighter-hard": 19},
    },
    "ladder-gathering-v2": {
        "easy": {},
        "normal": {"gatherer-easy": 1},
        "hard": {"gatherer-easy": 3},
        "tough": {"gatherer-easy": 9},
        "severe": {"gatherer-easy": 7, "gatherer": 2},
        "brutal": {"gatherer-easy": 4, "gatherer": 5},
        "extreme": {"gatherer-hard": 13},
        "expert": {"gatherer-hard": 29},
    },
    "ladder-battle-v2": {
        "easy": {"walker-easy": 3},
        "normal": {"gatherer-easy": 1},
        "hard": {"gatherer-easy": 3},
        "tough": {"gatherer-easy": 6},
        "severe": {"gatherer-easy": 9},
        "brutal": {"gatherer-easy": 6, "fighter-easy": 3},
        "extreme": {"fighter": 9},
        "expert": {"fighter-hard": 19},
    },
}
LADDERS: dict[str, tuple[str, dict[str, Any]]] = {  # of which track, with which options
    "ladder-gathering": ("gathering", COMMON),
    "ladder-battle": ("battle", BATTLE),
    "ladder-gathering-v2": ("gathering", COMMON),
    "ladder-battle-v2": ("battle", BATTLE),
}


def preset_options(name: Any, track: str, level: Any = "normal") -> dict[str, Any]:
    """Return the options of a preset or of a ladder's level."""
    known = PRESETS | LADDERS
    if not isinstance(name, str) or name not in known:
        raise ValueError(f"preset is {name!r}; the presets are {', '.join(known)}")
    of_track, options = known[name]
    if of_track != track:
        raise ValueError(f"preset {name!r} is for the track {of_track!r}, not for {track!r}")
    for own_level, robots in COMPANY.get(name, {}).items():  # a level that does not exist is refused later
        if own_level == level:
            opponents = tuple(robot for robot, count in robots.items() for _ in range(count))
            return options | {"opponents": opponents}
    return options

"""What agents are told, made by hand."""

from typing import Any

from wildscav import MatchInfo, Observation, SupplyWave, VisibleAgent
from wildscav.agent import Vector

NOWHERE: Vector = (0.0, 0.0, 0.0)


def seen(**changes: Any) -> Observation:
    """An observation of a healthy agent at the origin that looks north, with changes."""
    fields: dict[str, Any] = {
        "step": 0,
        "frame": 0,
        "time": 0.0,
        "time_bank": 30.0,
        "position": NOWHERE,
        "velocity": NOWHERE,
        "yaw": 0.0,
        "pitch": 0.0,
        "on_ground": True,
        "in_water": False,
        "alive": True,
        "health": 100,
        "clip": 15,
        "spare_ammo": 60,
        "reloading": False,
        "fired": False,
        "hit_seat": None,
        "hit_by_seat": None,
        "invincible": False,
        "respawn_in": 0.0,
        "can_pick_up": False,
        "supplies": 0,
        "gained": 0,
    }
    return Observation(**{**fields, **changes})


def enemy(position: Vector, velocity: Vector = NOWHERE, health: int = 100, **changes: Any) -> VisibleAgent:
    """An enemy in sight."""
    fields = {"seat": 1, "team": 1, "yaw": 0.0, "invincible": False, **changes}
    return VisibleAgent(position=position, velocity=velocity, health=health, **fields)


def match_info(**changes: Any) -> MatchInfo:
    """A match of 100 m with one wave of supplies in the middle."""
    fields: dict[str, Any] = {
        "track": "battle",
        "seat": 0,
        "seats": 2,
        "team": 0,
        "time_limit": 60.0,
        "frames_per_action": 5,
        "map_size": 100.0,
        "start": NOWHERE,
        "target": None,
        "supply_waves": (SupplyWave(time=0.0, center=(0.0, 0.0), radius=30.0),),
        "seed": 1,
        "step_budget": 0.1,
        "time_bank": 30.0,
        "target_distance": 1.0,
        "pick_up_distance": 1.5,
        "supply_sight": 20.0,
        "clip_size": 15,
        "start_health": 100,
    }
    return MatchInfo(**{**fields, **changes})

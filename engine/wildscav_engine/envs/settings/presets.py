"""Setups by name: those of the paper's experiments, and the ladders of gathering and battle."""

from typing import Any

from wildscav_engine.envs.settings.ladders import LADDERS, company_on

# Per action: 120 s for the paper's 400 actions in navigation and capture, 180 s for its 600 in gathering.
PAPER_FRAMES = 15

PRESETS: dict[str, tuple[str, dict[str, Any]]] = {
    "paper-navigation": (
        "navigation",
        {
            "map": 103,
            "time_limit": 120.0,
            "frames_per_action": PAPER_FRAMES,
            "action_mode": "baseline",
            "sensors": {"depth": {"width": 10, "height": 10}},
            "rewards": {"target_reached": 1.0},
        },
    ),
    "paper-gathering": (
        "gathering",
        {
            "map": 101,
            "agents": 4,
            "teams": (0, 0, 0, 0),
            "time_limit": 180.0,
            "frames_per_action": PAPER_FRAMES,
            "action_mode": "baseline",
            "sensors": {"depth": {"width": 10, "height": 10}, "nearby_supplies": {"limit": 8}},
            "rewards": {"supply_found": 1.0},
        },
    ),
    "paper-capture": (
        "capture",
        {
            "map": 101,
            "agents": 4,
            "time_limit": 120.0,
            "frames_per_action": PAPER_FRAMES,
            "action_mode": "baseline",
            "sensors": {"depth": {"width": 10, "height": 10}},
            "rewards": {"target_reached": 1.0},
        },
    ),
}


def preset_options(name: str, track: str, level: Any = "normal") -> dict[str, Any]:
    """Return the options of a preset or of a ladder's level."""
    if name not in (known := PRESETS | LADDERS):
        raise ValueError(f"preset is {name!r}; the presets are {', '.join(known)}")
    of_track, options = known[name]
    if of_track != track:
        raise ValueError(f"preset {name!r} is for the track {of_track!r}, not for {track!r}")
    return options | (company_on(name, level) if name in LADDERS else {})

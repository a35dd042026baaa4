"""The setups of the paper's experiments, by name."""

from typing import Any

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


def preset_options(name: str, track: str) -> dict[str, Any]:
    """Return the options of a preset.

    Raises:
        ValueError: There is no preset of this name, or it is for another track.
    """
    if name not in PRESETS:
        raise ValueError(f"preset is {name!r}; the presets are {', '.join(PRESETS)}")
    of_track, options = PRESETS[name]
    if of_track != track:
        raise ValueError(f"preset {name!r} is for the track {of_track!r}, not for {track!r}")
    return dict(options)

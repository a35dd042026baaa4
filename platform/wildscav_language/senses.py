"""The sensors of a seat of words."""

from typing import Any

from wildscav.skills.gathering import RINGS

FIELD_OF_VIEW = 90.0  # degrees
VIEW = {"width": 48, "height": 27, "field_of_view": FIELD_OF_VIEW}
PICTURE = {"width": 480, "height": 270, "field_of_view": FIELD_OF_VIEW, "quality": "fast"}


def sensors(*, pictures: bool = False) -> dict[str, dict[str, Any]]:
    """Return the sensors that a seat of words needs, with a camera or without, and their options."""
    found: dict[str, dict[str, Any]] = {
        "zone": {},
        "teammates": {},
        "lidar": {"channels": 30, "azimuths": 96, **RINGS._asdict()},
        "segmentation": VIEW,
        "depth": {**VIEW, "far": 60.0},
    }
    return found | ({"camera": PICTURE} if pictures else {})

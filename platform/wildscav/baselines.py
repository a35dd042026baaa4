"""The baseline agents that come with Wildscav: opponents, and starting points for submissions."""

from pathlib import Path

from wildscav.errors import UserError
from wildscav.terminal.suggestions import did_you_mean

ALL_ROUND = ("random", "homing", "hunter")  # those that play every track
NAMES = (
    *ALL_ROUND,
    "scavenger",
    "commando",
    "survivor",
    "navigator",
    "mapper",
    "learned-navigator",
    "learned-scavenger",
    "learned-commando",
    "cloned-navigator",
)
PREFIX = "baseline:"
PACKAGE = Path(__file__).parent
# In an installed wheel they are inside the package, in a checkout in its top folder.
PLACES = (PACKAGE / "submissions", PACKAGE.parents[1] / "submissions")


def is_baseline(text: str) -> bool:
    """Return whether a text names a baseline: "baseline:homing", or "homing" if no file is called that."""
    return text.startswith(PREFIX) or (text in NAMES and not Path(text).exists())


def baseline_folder(text: str) -> Path:
    """Return a baseline's folder by its name, perhaps after "baseline:"; a UserError if there is none."""
    name = text.removeprefix(PREFIX)
    if name not in NAMES:
        raise UserError(
            f"there is no baseline {name!r}{did_you_mean(name, NAMES)}; the baselines are {', '.join(NAMES)}",
            exit_code=2,
        )
    return next((place / name for place in PLACES if (place / name).is_dir()), PLACES[0] / name)

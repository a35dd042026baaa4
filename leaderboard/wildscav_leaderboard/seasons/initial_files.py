"""The files of a new season: commented settings, a template of rules, two secrets, and their commitments."""

import os
import re
from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from pathlib import Path

from wildscav.errors import UserError
from wildscav_evaluator.suites.seeds import commitment_of, new_secret
from wildscav_leaderboard.seasons.folder import FINAL_SECRET_FILE, SECRET_FILE, place_for
from wildscav_leaderboard.seasons.names import NAME
from wildscav_leaderboard.seasons.settings import SETTINGS_FILE, parse_settings

COMMITMENTS_FILE = "commitments.txt"
RULES_FILE = "rules.md"
TEMPLATE = Path(__file__).with_name("season_template.toml")
RULES_TEMPLATE = Path(__file__).with_name("rules_template.md")


def make_season_folder(folder: Path, name: str | None, title: str | None, days: int) -> tuple[str, str]:
    """Make a season's folder, whole or not at all, and return the commitments to its secrets.

    Args:
        folder: The folder, which must be missing or empty.
        name: The season's name; the folder's name if None.
        title: Its title; made from the name if None.
        days: How long it is open, from the next midnight of UTC on.

    Returns:
        The commitment to the secret of the season, and to that of its final matches.

    Raises:
        UserError: The folder has something in it, or cannot be made, or a name is not allowed.
    """
    name = name or re.sub(r"[^a-z0-9-]+", "-", folder.absolute().name.lower()).strip("-")
    if NAME.fullmatch(name) is None:
        raise UserError(f"--name is {name!r}, must be 2 to 40 of a-z, 0-9 and -", exit_code=2)
    title = title or name.replace("-", " ").capitalize()
    rules = RULES_TEMPLATE.read_text("utf-8").replace("{title}", title)
    settings = settings_text(name, title, datetime.now(UTC), days)
    return write_season_folder(folder, {SETTINGS_FILE: settings, RULES_FILE: rules})


def write_season_folder(folder: Path, texts: Mapping[str, str]) -> tuple[str, str]:
    """Write the files of a new season and new secrets into its folder, or nothing; return the commitments.

    Args:
        folder: The folder, which must be missing or empty.
        texts: The content of each file, the settings among them.

    Raises:
        UserError: The folder has something in it, or cannot be made, or the settings are not valid.
    """
    folder = folder.absolute()
    parse_settings(texts[SETTINGS_FILE], folder / SETTINGS_FILE)
    secret, final = new_secret(), new_secret()
    with place_for(folder, "the season's folder cannot be made") as place:
        made = place / "season"
        made.mkdir(mode=0o700)
        for name, text in texts.items():
            (made / name).write_text(text, "utf-8")
        _write_secret(made / SECRET_FILE, secret)
        _write_secret(made / FINAL_SECRET_FILE, final)
        (made / COMMITMENTS_FILE).write_text(commitments_text(secret, final), "ascii")
        made.rename(folder)
    return commitment_of(secret), commitment_of(final)


def commitments_text(secret: bytes, final: bytes) -> str:
    """Return the commitments as ``sha256sum`` prints them, which can check them, too."""
    return f"{commitment_of(secret)}  {SECRET_FILE}\n{commitment_of(final)}  {FINAL_SECRET_FILE}\n"


def settings_text(name: str, title: str, now: datetime, days: int) -> str:
    """Return commented settings."""
    opens = now.replace(hour=0, minute=0, second=0, microsecond=0) + timedelta(days=1)
    closes = opens + timedelta(days=days)
    freezes = closes - timedelta(days=max(1, days // 10))
    quoted = title.replace("\\", "\\\\").replace('"', '\\"')
    text = TEMPLATE.read_text("utf-8").format(
        name=name, title=quoted, opens=_written(opens), closes=_written(closes), freezes=_written(freezes)
    )
    # The comments stand below each other, however long the values are.
    return re.sub(
        r"^(\w+ = .*\S) +# (.*)$", lambda line: f"{line[1]:<37} # {line[2]}", text, flags=re.MULTILINE
    )


def _written(moment: datetime) -> str:
    return f"{moment:%Y-%m-%dT%H:%M:%SZ}"


def _write_secret(path: Path, secret: bytes) -> None:
    """Write the secret so that nobody else can read it."""
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    with os.fdopen(descriptor, "wb") as file:
        file.write(secret)

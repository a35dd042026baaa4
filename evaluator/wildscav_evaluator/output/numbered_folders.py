"""Numbered output folders: where an evaluation, and what the agents of one match print, goes by default.

Their names consist of an increasing number and who plays, such as ``0003-my-agent``. The same evaluation
finds its folder again by its identity, even after others were evaluated.
"""

import re
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from wildscav.errors import UserError
from wildscav_evaluator.output.identity import Identity, read_identity

OUT = Path("out")  # holds all output folders that are not named
EVALUATIONS = OUT / "evaluations"
COMPARISONS = OUT / "comparisons"
TOURNAMENTS = OUT / "tournaments"
PLAYED = OUT / "play"  # the agents' output in single matches
NUMBERED = re.compile(r"(\d{4,})-.+")


def own_folder(parent: Path, identity: Identity, *, fresh: bool) -> Path:
    """Return an evaluation's numbered folder: the one that holds it, unless it is ``fresh``, or the next."""
    if not fresh:
        for folder in reversed(numbered(parent)):
            if identity_in(folder) == identity:
                return folder
    return next_folder(parent, [one.name for one in identity.submissions])


def next_folder(parent: Path, names: Sequence[str]) -> Path:
    """Return the numbered folder that follows all in a folder, labelled with some submissions' names."""
    found = parent.iterdir() if parent.is_dir() else ()  # files, too: their names are taken
    last = max((number_of(path) for path in found if NUMBERED.fullmatch(path.name)), default=0)
    return parent / f"{last + 1:04}-{_label(names)}"


def make_next_folder(parent: Path, names: Sequence[str]) -> Path:
    """Make the next numbered folder, which nobody else has: another process may make one at the same time."""
    while True:
        folder = next_folder(parent, names)
        with suppress(FileExistsError):
            folder.mkdir(parents=True)
            return folder


def numbered(parent: Path) -> list[Path]:
    """Return the numbered folders in a folder, in order; an empty list if it does not exist."""
    folders = [path for path in parent.iterdir() if path.is_dir()] if parent.is_dir() else []
    return sorted((path for path in folders if NUMBERED.fullmatch(path.name)), key=number_of)


def number_of(folder: Path) -> int:
    """Return the number of a numbered folder."""
    return int(folder.name.partition("-")[0])


def identity_in(folder: Path) -> Identity | None:
    """Return the identity of the evaluation in a folder; None if it has none that this version can read."""
    try:
        return read_identity(folder)
    except UserError:
        return None


def _label(names: Sequence[str]) -> str:
    first, *others = names
    return f"{first}-and-{len(others)}-more" if len(others) > 1 else "-".join(names)

"""Numbered output folders: where an evaluation goes if nobody says where.

They are called by a number that grows and by what is evaluated, such as ``0003-my-agent``. The same
evaluation finds its folder again by its identity, whatever has been evaluated since.
"""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from wildscav.errors import UserError
from wildscav_evaluator.output.identity import Identity, read_identity

EVALUATIONS = Path("out/evaluations")
COMPARISONS = Path("out/comparisons")
NUMBERED = re.compile(r"(\d{4,})-.+")


def own_folder(parent: Path, identity: Identity, *, fresh: bool) -> Path:
    """Return the folder of an evaluation: the one that holds it already, else one with the next number.

    Args:
        parent: Of the numbered folders.
        identity: The evaluation.
        fresh: Whether it gets a new folder even if one holds it.
    """
    folders = numbered(parent)
    if not fresh:
        for folder in reversed(folders):
            if identity_in(folder) == identity:
                return folder
    last = number_of(folders[-1]) if folders else 0
    return parent / f"{last + 1:04}-{_label([one.name for one in identity.submissions])}"


def numbered(parent: Path) -> list[Path]:
    """Return the numbered folders of a folder, in their order; none if it does not exist."""
    return sorted(_numbered(parent), key=number_of) if parent.is_dir() else []


def _numbered(parent: Path) -> Iterator[Path]:
    for path in parent.iterdir():
        if NUMBERED.fullmatch(path.name) and path.is_dir():
            yield path


def number_of(folder: Path) -> int:
    """Return the number of a numbered folder."""
    return int(folder.name.partition("-")[0])


def identity_in(folder: Path) -> Identity | None:
    """Return which evaluation a folder holds; none if it does not say, or not in a way of this version."""
    try:
        return read_identity(folder)
    except UserError:
        return None


def _label(names: Sequence[str]) -> str:
    first, *others = names
    return f"{first}-and-{len(others)}-more" if len(others) > 1 else "-".join(names)

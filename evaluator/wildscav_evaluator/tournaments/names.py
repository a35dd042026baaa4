"""The names of a tournament's entrants: each is unique and does not depend on the order of the entrants.

An entrant has the name of its submission. If several entries of one submission take part, such as two
versions of it, each name is followed by its version, and by more if that is not enough.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby

from wildscav.errors import UserError
from wildscav_evaluator.submissions.submission import Submission

VERSION, ENTRY = "@", "#"  # neither is a character of a submission's name; ENTRY is none of a version either
DIGITS = 8  # of the digest, where two entries have one name and one version


def submission_of(entrant: str) -> str:
    """Return the name of the submission that an entrant is an entry of."""
    return entrant.partition(VERSION)[0].partition(ENTRY)[0]


def groups_of(entrants: Sequence[str]) -> list[int]:
    """Return the number of the submission that each entrant is an entry of."""
    numbers: dict[str, int] = {}
    return [numbers.setdefault(submission_of(name), len(numbers)) for name in entrants]


def with_unique_names(submissions: Sequence[Submission], *, meet_own: bool) -> tuple[Submission, ...]:
    """Return submissions with unique names, sorted by name.

    UserError if the same files are entered several times, unless entries of one submission may meet
    (``meet_own``).
    """
    renamed = []
    in_order = sorted(submissions, key=lambda one: (one.name, one.manifest.version, one.digest))
    for _, same in groupby(in_order, key=lambda one: one.name):
        entries = tuple(same)
        names = _names(entries)
        if len(set(names)) < len(names):
            if not meet_own:
                raise UserError(
                    f"submission {entries[0].name!r} is entered twice with the same files; "
                    "--meet-own lets entries of one submission meet",
                    exit_code=2,
                )
            names = [f"{name}{ENTRY}{number}" for number, name in enumerate(names, start=1)]
        renamed += [replace(one, entered_as=name) for one, name in zip(entries, names, strict=True)]
    return tuple(sorted(renamed, key=lambda one: one.name))


def _names(entries: Sequence[Submission]) -> list[str]:
    """Return a name for each entry of one submission; equal names only for equal files."""
    if len(entries) == 1:
        return [entries[0].name]
    names = [f"{one.name}{VERSION}{one.manifest.version}" for one in entries]
    if len(set(names)) == len(names) or len({one.digest for one in entries}) == 1:
        return names
    return [f"{name}{ENTRY}{one.digest[:DIGITS]}" for name, one in zip(names, entries, strict=True)]

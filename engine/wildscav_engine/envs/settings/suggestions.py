"""Suggestions in errors about names that do not exist."""

from collections.abc import Iterable
from difflib import get_close_matches


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return a suggestion to append to an error, such as " (did you mean 'target'?)", or nothing."""
    near = get_close_matches(name, known, n=2, cutoff=0.7)
    return f" (did you mean {' or '.join(map(repr, near))}?)" if near else ""

"""Suggestions for mistyped names."""

from collections.abc import Iterable
from difflib import get_close_matches


def did_you_mean(word: str, words: Iterable[str]) -> str:
    """Return a suggestion to append to an error, such as " (did you mean 'battle'?)".

    It is empty if no word is similar.
    """
    known = list(words)
    near = [known_word for known_word in known if word and known_word.startswith(word)]
    near = near or get_close_matches(word, known, n=2)
    return f" (did you mean {' or '.join(map(repr, near[:2]))}?)" if near else ""

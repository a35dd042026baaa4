"""Untrusted text as anybody may send it, and what may reach a terminal."""

from hypothesis import strategies as st

ANYTHING = st.text(st.characters(categories=None), max_size=40)
HOSTILE = "\x1b]0;mine\x07\x1b[2J\x9b2J[/]\u202e\ud800\x7f"


def is_plain(text: str) -> bool:
    return all(character.isprintable() or character == "\n" for character in text)

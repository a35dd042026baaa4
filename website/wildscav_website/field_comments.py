"""An extension that lets mkdocstrings show the comment beside a field as the field's description.

The project describes fields once, in the comment beside or above them, with unit and shape.
"""

import io
import re
import tokenize
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import griffe


class FieldComments(griffe.Extension):
    """Gives every attribute without a docstring its comment."""

    def on_attribute_instance(self, *, attr: griffe.Attribute, **_: Any) -> None:
        """Read the comment of an attribute."""
        if attr.docstring is not None or attr.lineno is None or not isinstance(attr.filepath, Path):
            return
        lines = attr.lines_collection[attr.filepath]
        if comment := meaning_of(lines, attr.lineno, attr.endlineno or attr.lineno):
            attr.docstring = griffe.Docstring(
                comment, lineno=attr.lineno, endlineno=attr.endlineno, parent=attr
            )


def meaning_of(lines: Sequence[str], first: int, last: int) -> str:
    """Return what is said of a statement: the last comment in its lines, or else the one right above them.

    A comment above that ends with a colon is the heading of several statements, and says nothing of one.
    """
    above = first - 1
    while above and lines[above - 1].lstrip().startswith("#"):
        above -= 1
    if beside := _comments(lines[first - 1 : last]):
        return beside[-1]
    said = " ".join(_comments(lines[above : first - 1]))
    return "" if said.endswith(":") else said


def _comments(lines: Sequence[str]) -> list[str]:
    try:
        return list(filter(None, comments_of("\n".join(lines)).values()))
    except (tokenize.TokenError, IndentationError):  # not a complete statement
        return []


def comments_of(source: str) -> dict[int, str]:
    """Return the comment of each line that has one, without what is said to tools."""
    tokens = tokenize.generate_tokens(io.StringIO(source + "\n").readline)
    comments = {one.start[0]: one.string.lstrip("# ") for one in tokens if one.type == tokenize.COMMENT}
    return {line: re.split(r"(?:^|# )(?:noqa|type:)", said)[0].strip() for line, said in comments.items()}

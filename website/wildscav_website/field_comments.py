"""An extension that lets mkdocstrings show the comment beside a field as the field's description.

The project describes fields once, in the comment at the end of their line, with unit and shape.
"""

import io
import re
import tokenize
from typing import Any

import griffe


class FieldComments(griffe.Extension):
    """Gives every attribute without a docstring the comment at the end of its line."""

    def on_attribute_instance(self, *, attr: griffe.Attribute, **_: Any) -> None:
        """Read the comment beside an attribute."""
        if attr.docstring is None and (comment := _comment(attr.source)):
            attr.docstring = griffe.Docstring(
                comment, lineno=attr.lineno, endlineno=attr.endlineno, parent=attr
            )


def _comment(source: str) -> str:
    """Return the comment in the last line of some source code, or an empty string."""
    try:
        return comments_of(source).get(len(source.splitlines()), "")
    except tokenize.TokenError:  # not a complete statement
        return ""


def comments_of(source: str) -> dict[int, str]:
    """Return the comment of each line that has one, without what is said to tools."""
    tokens = tokenize.generate_tokens(io.StringIO(source + "\n").readline)
    comments = {one.start[0]: one.string.lstrip("# ") for one in tokens if one.type == tokenize.COMMENT}
    return {line: re.split(r"(?:^|# )(?:noqa|type:)", said)[0].strip() for line, said in comments.items()}

"""Lets mkdocstrings show the comment beside a field as the field's description.

The project describes fields once, in the comment at the end of their line: unit, shape, what it is.
"""

import io
import tokenize
from typing import Any

import griffe


class FieldComments(griffe.Extension):
    """Gives every attribute without a docstring the comment of its line."""

    def on_attribute_instance(self, *, attr: griffe.Attribute, **_: Any) -> None:
        """Look beside an attribute that is read."""
        if attr.docstring is None and (comment := _comment(attr)):
            text = comment[:1].upper() + comment[1:]
            attr.docstring = griffe.Docstring(text, lineno=attr.lineno, endlineno=attr.endlineno, parent=attr)


def _comment(attr: griffe.Attribute) -> str:
    """Return the comment in the lines of an attribute, nothing if there is none."""
    try:
        tokens = list(tokenize.generate_tokens(io.StringIO(attr.source + "\n").readline))
    except tokenize.TokenError:
        return ""
    comments = [token.string.lstrip("# ") for token in tokens if token.type == tokenize.COMMENT]
    comments = [one for one in comments if not one.startswith(("noqa", "type:"))]
    return " ".join(comments).partition("  # noqa")[0]

"""An extension that lets mkdocstrings show the comment beside a field as the field's description.

The project describes fields once, in the comment at the end of their line, with unit and shape.
"""

import io
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
    last = len(source.splitlines())
    try:
        tokens = list(tokenize.generate_tokens(io.StringIO(source + "\n").readline))
    except tokenize.TokenError:  # not a complete statement
        return ""
    for token in tokens:
        if token.type == tokenize.COMMENT and token.start[0] == last:
            comment = token.string.lstrip("# ").partition("# noqa")[0].partition("# type:")[0]
            return "" if comment.startswith(("noqa", "type:")) else comment.strip()
    return ""

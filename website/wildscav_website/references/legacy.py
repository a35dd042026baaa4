"""The fields of an episode of the original game's client, for the page about it."""

import inspect
import re

from wildscav_legacy import episode
from wildscav_website.field_comments import comments_of
from wildscav_website.markdown import code, table

POINTER = re.compile(r"`FIELDS` in\s\[`episode.py`\]\(\S+\) has")  # in the repository, the page has no table
AFTER = "## What an episode may ask for"  # the heading below which the table stands


def with_fields(page: str) -> str:
    """Return the page with a table of all fields at the end of that section."""
    opening, section, rest = POINTER.sub("The table has", page).partition(AFTER)
    text, heading, rest = rest.partition("\n## ")
    return "".join([opening, section, text, "\n", fields(), heading, rest])


def fields() -> str:
    """Return the table: what a field is if it is not sent, its range, and the comment beside it."""
    lines = inspect.getsource(episode).splitlines()
    comments = comments_of("\n".join(lines))
    meanings = {
        line.split('"')[1]: comments.get(number, "")
        for number, line in enumerate(lines, 1)
        if ": Number(" in line
    }
    rows = [
        (code(name), *(f"{value:.12g}" for value in number), meanings[name])
        for name, number in episode.FIELDS.items()
    ]
    return table(("field", "default", "least", "most", ""), rows)

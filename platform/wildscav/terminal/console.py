"""What every command prints with: the consoles, and how text and commands are shown.

Much of what is shown is untrusted text: versions and names of submissions, what agents print, what
records say. ``printable`` makes any text plain, and every way to a terminal goes through it: the consoles
here by themselves, log lines in ``wildscav.monitoring.logs``. JSON is written in ASCII by ``ascii_json``.
"""

import json
import re
import shutil
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment
from rich.text import Text

LAYOUT = "\n\t"  # what a console lays text out by


def printable(text: str, keep: str = "") -> str:
    """Return a text that cannot steer a terminal: whatever is no plain character stands as its escape.

    That goes for control characters, for marks that change the direction of text, for what has no width, and
    for halves of characters (surrogates), which no stream could encode.

    Args:
        text: Any text.
        keep: Characters to leave as they are.
    """
    if text.isprintable():
        return text
    return "".join(
        character
        if character.isprintable() or character in keep
        else character.encode("unicode_escape").decode("ascii")
        for character in text
    )


class PlainConsole(Console):
    """A console on which a string is just a string.

    No string is read as markup, and no text reaches the terminal but through ``printable``. Style is what our
    own code gives to a ``Text``.
    """

    def __init__(self, **settings: Any) -> None:
        super().__init__(markup=False, emoji=False, highlight=False, **settings)

    def render_str(self, text: str, **options: Any) -> Text:
        """Return a string as it is laid out, with the width that it will have."""
        return super().render_str(printable(text, LAYOUT), **options)

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """Yield what a renderable puts on the terminal."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=printable(segment.text, LAYOUT))


console = PlainConsole()
error_console = PlainConsole(stderr=True)


def print_json(content: object) -> None:
    """Print a value as a JSON document on stdout, in characters of ASCII alone."""
    sys.stdout.write(f"{ascii_json(json.dumps(content, indent=2))}\n")


def ascii_json(document: str) -> str:
    """Return a JSON document with escapes for all that is not printable ASCII; it says the same."""
    # Outside of its strings JSON has nothing else, and json.dumps escapes a single character as JSON does.
    return re.sub(
        "[^\x00-\x7e]",
        lambda found: f"\\u{ord(found[0]):04x}" if found[0] == "\x7f" else json.dumps(found[0])[1:-1],
        document,
    )


def counted(count: int, noun: str) -> str:
    """Return a count with its noun, such as "1 match" and "1,000 matches"."""
    plural = "es" if noun.endswith("h") else "s"
    return f"{count:,} {noun}{'' if count == 1 else plural}"


def command(name: str) -> str:
    """Return what to type to run a program that was installed with this one."""
    beside = Path(sys.executable).parent / name
    found = shutil.which(name)
    if found is not None and Path(found).absolute() == beside.absolute():
        return name
    here = Path.cwd()
    return str(beside.relative_to(here) if beside.is_relative_to(here) else beside)

"""The consoles that all commands print with, and how text and commands are shown.

Much of what is shown is untrusted: names and versions of submissions, output of agents, contents of records.
``printable`` escapes any text, and all text for a terminal goes through it: the consoles here apply it
themselves, and the log of servers applies it to its lines. ``ascii_json`` does the same for JSON.
"""

import json
import re
import shlex
import shutil
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment
from rich.text import Text

if TYPE_CHECKING:
    from rich.progress import Progress, ProgressColumn

TELLING = 10.0  # s between lines that tell how far something is, where there is no terminal
LAYOUT = "\n\t"  # control characters that consoles keep, because they lay out text


def printable(text: str, keep: str = "") -> str:
    """Return a text that cannot control a terminal: all that is neither printable nor kept is escaped.

    These are control characters, marks that change the direction of text, characters without width, and
    surrogates, which no stream could encode.
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
    """A console that prints strings literally.

    Strings are not parsed as markup, and all text goes through ``printable`` on its way to the terminal.
    Styles come only from ``Text`` objects, which our own code makes.
    """

    def __init__(self, **settings: Any) -> None:
        super().__init__(markup=False, emoji=False, highlight=False, **settings)

    def print(self, *objects: Any, soft_wrap: bool | None = None, **options: Any) -> None:
        """Print. Lines of text stay whole, to be searched and copied; everything else is laid out."""
        is_text = all(isinstance(one, str | Text) for one in objects)
        super().print(*objects, soft_wrap=is_text if soft_wrap is None else soft_wrap, **options)

    def render_str(self, text: str, **options: Any) -> Text:
        """Return a string, escaped before it is measured and laid out."""
        return super().render_str(printable(text, LAYOUT), **options)

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """Yield the segments of a renderable, escaped."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=printable(segment.text, LAYOUT))


console = PlainConsole()
error_console = PlainConsole(stderr=True)


def console_above(shown: Console) -> Console:
    """Return what prints lines for stdout while another console shows a spinner or a bar on the terminal."""
    return shown if console.is_terminal and shown.is_terminal else console


@contextmanager
def telling(first: str = "") -> Iterator[Callable[[str], None]]:
    """Yield what shows on stderr how far something is: in place in a terminal, else a line now and then."""
    shown = time.monotonic()
    with error_console.status(first) as status:

        def tell(text: str) -> None:
            nonlocal shown
            status.update(printable(text))
            if not error_console.is_terminal and time.monotonic() - shown > TELLING:
                error_console.print(text)
                shown = time.monotonic()

        yield tell


def progress_bar(*columns: "ProgressColumn") -> "Progress":
    """Return a progress bar for stderr. It is shown on a terminal alone, and leaves nothing there.

    Args:
        columns: What stands beside the bar; by default how many are done, and how long the others take.
    """
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        *(columns or (MofNCompleteColumn(), TimeRemainingColumn())),
        console=error_console,
        transient=True,
        disable=not error_console.is_terminal,
    )


@contextmanager
def counting(what: str, unit: str = "") -> Iterator[Callable[[int, int], None]]:
    """Yield what shows in a progress bar how many are done, of how many."""
    from rich.progress import MofNCompleteColumn, TextColumn, TimeRemainingColumn

    with progress_bar(MofNCompleteColumn(), TextColumn(unit), TimeRemainingColumn()) as progress:
        task = progress.add_task(what, total=None)
        yield lambda done, total: progress.update(task, completed=done, total=total)


def print_json(content: object) -> None:
    """Print a value as a JSON document on stdout, in ASCII: models as their fields, others as their text."""
    sys.stdout.write(f"{ascii_json(json.dumps(content, indent=2, default=_as_json))}\n")


def _as_json(value: Any) -> Any:
    return value.model_dump(mode="json") if hasattr(value, "model_dump") else str(value)


def ascii_json(document: str) -> str:
    """Return an equal JSON document in which all characters but printable ASCII are escaped."""
    # Other characters occur only inside strings of JSON, where json.dumps escapes each of them.
    return re.sub(
        "[^\x00-\x7e]",
        lambda found: f"\\u{ord(found[0]):04x}" if found[0] == "\x7f" else json.dumps(found[0])[1:-1],
        document,
    )


def counted(count: int, noun: str) -> str:
    """Return a count with its noun, such as "1 match" and "1,000 matches"."""
    plural = "es" if noun.endswith("h") else "s"
    return f"{count:,} {noun}{'' if count == 1 else plural}"


def command(name: str, *arguments: object) -> str:
    """Return what to type in a shell to run a program that is installed beside this one, with arguments."""
    return " ".join([_found(name), *(shlex.quote(str(one)) for one in arguments)])


def _found(name: str) -> str:
    beside = Path(sys.executable).parent / name
    found = shutil.which(name)
    if found is not None and Path(found).absolute() == beside.absolute():
        return name
    here = Path.cwd()
    return str(beside.relative_to(here) if beside.is_relative_to(here) else beside)

"""What every command prints with: the consoles, and how text and commands are shown."""

import shutil
import sys
from pathlib import Path

from rich.console import Console

console = Console()
error_console = Console(stderr=True)

PREPARING = "preparing the engine (the first run compiles it, which takes a minute or two)"


def printable(text: str) -> str:
    """Return a text that cannot steer a terminal: whatever is no plain character stands as its escape."""
    return "".join(
        character if character.isprintable() else character.encode("unicode_escape").decode()
        for character in text
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

"""``wildscav init``: a new submission from a template, ready to play."""

import re
from importlib.resources import files
from pathlib import Path
from typing import Annotated

import typer

from wildscav.errors import UserError

TEMPLATE = ("submission.toml", "agent.py", "README.md")
LONGEST_NAME = 40  # characters


def init(
    folder: Annotated[Path, typer.Argument(help="Folder to make; it must be empty or not be there.")],
    name: Annotated[
        str | None, typer.Option(help="Name of the submission. Default: that of the folder.")
    ] = None,
) -> None:
    """Make a new submission from a template, ready to play."""
    from rich.text import Text

    from wildscav.console import console

    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise UserError(f"{folder} is not an empty folder: name one that is not there yet", exit_code=2)
    name = submission_name(folder.resolve().name) if name is None else _checked(name)
    folder.mkdir(parents=True, exist_ok=True)
    template = files("wildscav.cli") / "template"
    for file in TEMPLATE:
        text = (template / file).read_text("utf-8")
        (folder / file).write_text(text.replace("my-agent", name), "utf-8")
    console.print(Text.assemble((str(folder), "bold"), " holds a new agent, ", (name, "bold"), ". Next:"))
    console.print(f"  wildscav play {folder}", highlight=False, soft_wrap=True)
    console.print(f"  and open {folder / 'agent.py'} in an editor.", highlight=False, soft_wrap=True)


def submission_name(text: str) -> str:
    """Return the nearest thing to a text that a submission may be called."""
    name = re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:LONGEST_NAME].rstrip("-")
    return name if len(name) > 1 else "my-agent"


def _checked(name: str) -> str:
    if not re.fullmatch(rf"[a-z0-9][a-z0-9-]{{1,{LONGEST_NAME - 1}}}", name):
        raise UserError(
            f"--name is {name!r}: 2 to {LONGEST_NAME} of a-z, 0-9 and -, a letter or digit first", exit_code=2
        )
    return name

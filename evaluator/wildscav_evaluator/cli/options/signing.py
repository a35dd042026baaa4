"""The options ``--sign`` and ``--key``, and the passphrases of keys."""

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wildscav.errors import UserError

if TYPE_CHECKING:
    from wildscav_evaluator.ledger.keys import SigningKey
    from wildscav_evaluator.submissions.submission import Submission

PASSPHRASE = "WILDSCAV_KEY_PASSPHRASE"  # noqa: S105 - the name of a variable

SignOption = Annotated[
    Path | None,
    typer.Option(
        "--sign",
        help="Sign the evaluation's ledger with the key in this file (`wildscav key new`).",
        metavar="KEY",
        show_default=False,
    ),
]
KeyOption = Annotated[
    str | None,
    typer.Option(
        "--key",
        help="The organizer's public key, 64 hexadecimal digits or a file with them: demand that it signed "
        "all of this.",
        metavar="PUBLIC",
        show_default=False,
    ),
]


def signing_key(file: Path | None, out: Path, submissions: "Sequence[Submission]") -> "SigningKey | None":
    """Return the key to sign with, if one is asked for.

    Args:
        file: Its file.
        out: The output folder, which will be published.
        submissions: Who plays: agents can read their own folders.

    Raises:
        UserError: It cannot be used, or lies where others will see it.
    """
    if file is None:
        return None
    from wildscav_evaluator.ledger.keys import read_key

    place = file.resolve()
    for folder in (out.resolve(), *(one.folder.resolve() for one in submissions)):
        if place.is_relative_to(folder):
            raise UserError(f"--sign {file} is in {folder}, where others can see it: move it", exit_code=2)
    return read_key(file, lambda: ask_passphrase(file))


def warn_of_open_key(sandbox: str) -> None:
    """Warn that agents can read the key, if nothing keeps them from it."""
    from rich.text import Text

    from wildscav.terminal.console import console
    from wildscav_evaluator.sandbox import SANDBOXES

    if not SANDBOXES[sandbox].isolated:
        warning = f"agents in {sandbox} can read the key that signs, as you can: sign with agents you trust"
        console.print(Text.assemble(("warning: ", "yellow"), warning), soft_wrap=True)


def ask_passphrase(file: Path) -> str:
    """Return the passphrase of a key, from the environment or from whoever sits at the terminal.

    Raises:
        UserError: Nobody says it.
    """
    given = os.environ.get(PASSPHRASE)
    if given is not None:
        return given
    _need_terminal(f"{file} is encrypted")
    return str(typer.prompt(f"passphrase of {file}", hide_input=True, err=True))


def new_passphrase() -> str:
    """Return the passphrase of a new key, from the environment or from whoever sits at the terminal.

    Raises:
        UserError: Nobody says it, or it is empty.
    """
    given = os.environ.get(PASSPHRASE)
    if given is None:
        _need_terminal("a passphrase is wanted")
        given = str(typer.prompt("passphrase", hide_input=True, confirmation_prompt=True, err=True))
    if not given:
        raise UserError("the passphrase is empty: name one, or leave out --passphrase", exit_code=2)
    return given


def _need_terminal(why: str) -> None:
    if not sys.stdin.isatty():
        raise UserError(f"{why}, and there is no terminal to ask in: set {PASSPHRASE}", exit_code=2)

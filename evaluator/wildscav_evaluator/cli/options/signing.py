"""The options ``--sign`` and ``--key``, and the passphrases of keys."""

import os
import sys
from collections.abc import Iterable, Sequence
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
        help="Sign the evaluation's ledger with the key in this file (`wildscav season key new`).",
        metavar="KEY",
        show_default=False,
    ),
]
KeyOption = Annotated[
    str | None,
    typer.Option(
        "--key",
        help="The organizer's public key, 64 hexadecimal digits or a file with them: require that it signed "
        "the ledger.",
        metavar="PUBLIC",
        show_default=False,
    ),
]


def signing_key(file: Path | None, out: Path, submissions: "Sequence[Submission]") -> "SigningKey | None":
    """Return the key to sign with, or None if none is requested.

    UserError if it cannot be used, or lies where others see it: in ``out``, which will be published, or in
    the folder of a submission, which agents can read.
    """
    if file is None:
        return None
    from wildscav_evaluator.ledger.keys import read_key

    check_hidden("--sign", file, (out, *(one.folder for one in submissions)))
    return read_key(file, lambda: ask_passphrase(file))


def check_hidden(option: str, file: Path, folders: Iterable[Path]) -> None:
    """Refuse a file that lies in a folder where others see it."""
    for folder in folders:
        if file.resolve().is_relative_to(folder.resolve()):
            raise UserError(
                f"{option} {file} is in {folder.resolve()}, where others can see it: move it", exit_code=2
            )


def warn_of_open_key(sandbox: str) -> None:
    """Warn that agents can read the key, if the sandbox does not isolate them."""
    from rich.text import Text

    from wildscav.terminal.console import console
    from wildscav_evaluator.sandbox import SANDBOXES

    if not SANDBOXES[sandbox].isolated:
        warning = (
            f"agents in the sandbox {sandbox} can read the signing key: sign only with agents that you trust"
        )
        console.print(Text.assemble(("warning: ", "yellow"), warning))


def ask_passphrase(file: Path) -> str:
    """Return the passphrase of a key, from the environment or else asked for on the terminal."""
    given = os.environ.get(PASSPHRASE)
    if given is not None:
        return given
    _need_terminal(f"{file} is encrypted")
    return str(typer.prompt(f"passphrase of {file}", hide_input=True, err=True))


def new_passphrase() -> str:
    """Return the passphrase of a new key, likewise; UserError also if it is empty."""
    given = os.environ.get(PASSPHRASE)
    if given is None:
        _need_terminal("a passphrase is needed")
        given = str(typer.prompt("passphrase", hide_input=True, confirmation_prompt=True, err=True))
    if not given:
        raise UserError("the passphrase is empty: name one, or leave out --passphrase", exit_code=2)
    return given


def _need_terminal(why: str) -> None:
    if not sys.stdin.isatty():
        raise UserError(f"{why}, and there is no terminal to ask in: set {PASSPHRASE}", exit_code=2)

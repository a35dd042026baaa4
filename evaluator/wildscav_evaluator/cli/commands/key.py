"""The command ``wildscav season key``: the keys with which organizers sign evaluations."""

from pathlib import Path
from typing import Annotated

import typer

from wildscav.errors import UserError
from wildscav.terminal.console import console

app = typer.Typer(
    help="Organizers' keys: make one to sign evaluations with, and show its public half.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)

KeyFile = Annotated[Path, typer.Argument(help="File of the private key.", metavar="FILE", show_default=False)]


@app.command()
def new(
    file: KeyFile,
    passphrase: Annotated[
        bool,
        typer.Option(
            "--passphrase",
            help="Encrypt the file with the passphrase in WILDSCAV_KEY_PASSPHRASE; without that variable, "
            "the command asks for one.",
        ),
    ] = False,
) -> None:
    """Make a key that only you can read, and print its public half, which you publish."""
    from wildscav_evaluator.cli.options.signing import new_passphrase
    from wildscav_evaluator.ledger.keys import new_key

    if file.exists():
        raise UserError(f"{file} exists already: a key is never overwritten", exit_code=2)
    console.print(new_key(file, new_passphrase() if passphrase else None).public)


@app.command()
def public(file: KeyFile) -> None:
    """Print the public half of a key, 64 hexadecimal digits."""
    from wildscav_evaluator.cli.options.signing import ask_passphrase
    from wildscav_evaluator.ledger.keys import read_key

    console.print(read_key(file, lambda: ask_passphrase(file)).public)

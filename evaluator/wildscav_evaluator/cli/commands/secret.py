"""The command ``wildscav season secret``: hidden seeds, committed to in public and opened later."""

import os
from pathlib import Path
from typing import Annotated

import typer

from wildscav.errors import UserError, describe
from wildscav.terminal.console import command, console

app = typer.Typer(
    help="Hidden seeds of evaluations: make one, publish its commitment, open it afterwards.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)


@app.callback()
def secret() -> None:
    """Hide the seeds of an evaluation: make one, publish its commitment, open it afterwards."""


Secret = Annotated[Path, typer.Argument(help="The secret's file.", metavar="FILE", show_default=False)]
Out = Annotated[
    Path, typer.Argument(help="The output folder of an evaluation.", metavar="OUT", show_default=False)
]


@app.command()
def new(file: Secret) -> None:
    """Make a secret that only you can read, and print its commitment, which you publish at once."""
    from wildscav_evaluator.suites.seeds import commitment_of, new_secret

    content = new_secret()
    try:
        descriptor = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError as error:
        raise UserError(f"{file} exists already: a secret is never overwritten", exit_code=2) from error
    except OSError as error:
        raise UserError(f"the secret cannot be written: {describe(error)}") from error
    with os.fdopen(descriptor, "wb") as writer:
        writer.write(content)
    console.print(commitment_of(content))


@app.command()
def commitment(file: Secret) -> None:
    """Print a secret's commitment: the SHA-256 of its file."""
    from wildscav_evaluator.suites.seeds import read_secret

    console.print(str(read_secret(file).commitment))


@app.command("open")
def open_(file: Secret, out: Out) -> None:
    """Put a secret beside the results of its evaluation, so that all of it can be published and checked."""
    from wildscav_engine.storage.files import write_whole
    from wildscav_evaluator.output.layout import OPENED_FILE, RESULTS_FILE
    from wildscav_evaluator.output.results import read_results
    from wildscav_evaluator.suites.seeds import read_secret

    reported, seed = read_results(out / RESULTS_FILE), read_secret(file)
    if reported.commitment != seed.commitment:
        played = "a public seed" if reported.commitment is None else f"the secret of {reported.commitment}"
        raise UserError(f"{out} was evaluated on {played}, not on {file} ({seed.commitment})", exit_code=2)
    write_whole(out / OPENED_FILE, file.read_bytes())
    console.print(f"opened: {out / OPENED_FILE}")
    console.print(f"check it: {command('wildscav', 'verify', out, '--commitment', seed.commitment)}")

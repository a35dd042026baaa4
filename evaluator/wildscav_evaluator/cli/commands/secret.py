"""The command ``wildscav secret``: hidden seeds, which are committed to in public and opened afterwards."""

import os
import re
from pathlib import Path
from typing import Annotated

import typer

from wildscav.errors import UserError, describe
from wildscav.terminal.console import command, console, counted

app = typer.Typer(
    help="Hidden seeds of evaluations: make one, publish its commitment, open it afterwards, check one.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)


@app.callback()
def secret() -> None:
    """Hide the seeds of an evaluation: make one, publish its commitment, open it afterwards, check one."""


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
    _print(commitment_of(content))


@app.command()
def commitment(file: Secret) -> None:
    """Print a secret's commitment: the SHA-256 of its file."""
    from wildscav_evaluator.suites.seeds import read_secret

    _print(str(read_secret(file).commitment))


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
    _print(f"opened: {out / OPENED_FILE}")
    _print(f"check it: {command('wildscav', 'secret', 'check', out, seed.commitment)}")


@app.command()
def check(
    out: Out,
    commitment: Annotated[
        str, typer.Argument(help="The commitment as it was published beforehand.", show_default=False)
    ],
) -> None:
    """Check that the recorded matches are those that were committed to. Exit code 0 only if they are.

    Use `wildscav rescore` to check that the records are true accounts of those matches.
    """
    from wildscav_evaluator.scores.expected_matches import check_opened

    if not re.fullmatch("[0-9a-f]{64}", commitment):
        raise UserError(f"commitment is {commitment!r}, must be 64 hexadecimal digits", exit_code=2)
    records = check_opened(out, commitment)
    _print(
        f"the secret in {out} is the one committed to, and {counted(records, 'record')} "
        f"{'is of a match' if records == 1 else 'are of matches'} that the secret determines"
    )


def _print(text: str) -> None:
    console.print(text, soft_wrap=True, highlight=False)

"""The option ``--json`` of every command that prints a table."""

from typing import Annotated

import typer


def _keep_stdout_free(wanted: bool) -> bool:
    """Print everything else to stderr if stdout is to hold nothing but a JSON document."""
    from wildscav.terminal import console

    console.console.stderr = wanted
    return wanted


AsJson = Annotated[
    bool,
    typer.Option(
        "--json",
        help="Print one JSON document to stdout, and everything else to stderr.",
        callback=_keep_stdout_free,
        show_default=False,
    ),
]

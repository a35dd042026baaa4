"""The option ``--json`` of every command that prints a table."""

from typing import Annotated

import typer


def _keep_stdout_free(wanted: bool) -> bool:
    """Let everything that is said go to stderr if stdout is to hold a JSON document and nothing else."""
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

"""Reporting several errors, one line each."""

from collections.abc import Sequence

from rich.text import Text

from wildscav.errors import UserError
from wildscav.terminal.console import error_console


def raise_errors(errors: Sequence[str]) -> None:
    """Print every error on its own line, in the format of the command line; raise the last one.

    Raises:
        UserError: There was one.
    """
    if not errors:
        return
    for error in errors[:-1]:
        error_console.print(Text(f"wildscav: {' '.join(error.split())}"), soft_wrap=True)
    raise UserError(errors[-1])

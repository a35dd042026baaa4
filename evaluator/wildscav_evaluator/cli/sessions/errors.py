"""Several things that went wrong, one line each."""

from collections.abc import Sequence

from rich.text import Text

from wildscav.errors import UserError
from wildscav.terminal.console import error_console


def raise_all(complaints: Sequence[str]) -> None:
    """Print every complaint on a line of its own, in the way of the command line; the last one by raising it.

    Raises:
        UserError: There was one.
    """
    if not complaints:
        return
    for complaint in complaints[:-1]:
        error_console.print(Text(f"wildscav: {' '.join(complaint.split())}"), soft_wrap=True)
    raise UserError(complaints[-1])

"""What ``wildscav map make`` shows."""

from collections.abc import Sequence

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from wildscav.errors import UserError
from wildscav.terminal.console import console, counted, error_console
from wildscav_engine.maps.cache import folder
from wildscav_evaluator.executors import Executor
from wildscav_evaluator.map_making import Choices, make_maps, missing_maps


def run_make_maps(choices: Sequence[Choices], executor: Executor) -> None:
    """Make the maps that are not cached yet, and say how many and how large they are.

    Raises:
        UserError: One cannot be made, they do not fit into the cache, or the command was interrupted.
    """
    missing = missing_maps(choices)
    if len(missing) < len(choices):
        console.print(f"{len(choices) - len(missing):,} of {counted(len(choices), 'map')} were cached before")
    made, size = 0, 0
    columns = (TextColumn("making maps"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=error_console, transient=True) as progress:
        task = progress.add_task("", total=len(missing))
        try:
            for one in make_maps(missing, executor):
                made, size = made + 1, size + len(one.content)
                progress.advance(task)
        except KeyboardInterrupt:
            raise UserError(f"interrupted: {made:,} of {counted(len(missing), 'map')} made", 130) from None
    console.print(f"made {counted(made, 'map')}, {size / 1e6:,.0f} MB, in {folder()}", soft_wrap=True)

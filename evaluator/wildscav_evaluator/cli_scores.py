"""The command ``wildscav rescore``."""

from pathlib import Path
from typing import Annotated

import typer


def rescore(
    out: Annotated[Path, typer.Argument(help="The output folder of an evaluation.", show_default=False)],
    jobs: Annotated[
        int | None, typer.Option(help="Records to play at once. Default: one a processor core.", min=1)
    ] = None,
) -> None:
    """Play every record of an evaluation again and compute its tables anew. Exit code 0 only if all agree.

    Every number comes from the records. Which version of a submission played, and whose fault it was when an
    agent ended early, stands in the results alone.
    """
    from wildscav_evaluator.rescore_session import run_rescore
    from wildscav_evaluator.run import default_jobs

    run_rescore(out, jobs or default_jobs())

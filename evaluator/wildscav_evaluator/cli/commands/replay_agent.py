"""The command ``wildscav replay-agent``."""

from pathlib import Path
from typing import Annotated

import typer

from wildscav.system.output_folders import check_folder
from wildscav_evaluator.cli.options.running import InSandbox, chosen_sandbox


def replay_agent(
    record: Annotated[
        Path, typer.Argument(help="The record of a match.", metavar="RECORD", show_default=False)
    ],
    submission: Annotated[
        Path,
        typer.Argument(
            help="A folder with a submission.toml, an archive of one, or image:NAME.",
            metavar="SUBMISSION",
            show_default=False,
        ),
    ],
    seat: Annotated[
        list[int] | None,
        typer.Option(
            help="Compare this seat; may be repeated. Default: the submission's own seats in the record.",
            min=0,
        ),
    ] = None,
    logs: Annotated[Path, typer.Option(help="Folder for the agents' output.")] = Path("out/replay-agent"),
    sandbox: InSandbox = None,
) -> None:
    """Run a submission again in a recorded match, and compare its actions with the record, step by step.

    All seats play the recorded actions, so the agent sees exactly what it saw then. Exit code 0 if it acts as
    recorded in every step; otherwise 1, and the first difference is shown. An agent that reads a clock, or
    uses threads or its own random numbers, may differ although its code is the same.
    """
    from wildscav_evaluator.cli.options.selection import load_submissions
    from wildscav_evaluator.cli.sessions.replay_agent import run_again

    check_folder("--logs", logs)
    loaded = load_submissions([submission])
    runs_in, loaded = chosen_sandbox(sandbox, loaded)
    run_again(record, loaded[0], seats=seat or [], logs=logs, sandbox=runs_in)

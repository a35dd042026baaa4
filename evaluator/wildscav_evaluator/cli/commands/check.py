"""The command ``wildscav check``."""

from pathlib import Path
from typing import Annotated

import typer

from wildscav.cli.json_option import AsJson
from wildscav.errors import UserError, describe
from wildscav.system.output_folders import check_folder
from wildscav_evaluator.cli.options.sandbox import InSandbox, chosen_sandbox


def check(
    submission: Annotated[
        Path,
        typer.Argument(
            help="A submission: a folder, an archive or an image, as for evaluate.",
            metavar="SUBMISSION",
            show_default=False,
        ),
    ],
    logs: Annotated[Path, typer.Option(help="Folder for the agent's output.")] = Path("out/check"),
    sandbox: InSandbox = None,
    as_json: AsJson = False,
) -> None:
    """Check whether a submission keeps the rules, in the judge's sandbox with its clock and its limits.

    The submission plays a match of the quick suite on each of its tracks, one in which it is always late, and
    one that is cancelled. Every failure is explained, with advice on how to fix it.
    """
    from wildscav_evaluator.cli.options.selection import load_submissions
    from wildscav_evaluator.cli.sessions.check import run_check
    from wildscav_evaluator.sandbox import SANDBOXES

    check_folder("--logs", logs)
    loaded = load_submissions([submission])
    name, (runs,) = chosen_sandbox(sandbox, loaded)
    try:
        run_check(runs, SANDBOXES[name], logs, as_json=as_json)
    except OSError as error:
        raise UserError(describe(error)) from error

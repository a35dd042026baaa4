"""The command ``wildscav rescore``."""

from pathlib import Path
from typing import Annotated

import typer

from wildscav.cli.json_option import AsJson
from wildscav_evaluator.cli.options.signing import KeyOption


def rescore(
    out: Annotated[Path, typer.Argument(help="The output folder of an evaluation.", show_default=False)],
    jobs: Annotated[
        int | None, typer.Option(help="Records to play at once. Default: one per processor core.", min=1)
    ] = None,
    key: KeyOption = None,
    as_json: AsJson = False,
) -> None:
    """Play every record of an evaluation again and recompute its tables. Exit code 0 only if all agree.

    Every number comes from the records, and every entrant must have exactly the matches of the suite. Only a
    ledger that the organizer signed (--key) proves which submission played, in which sandbox, and whose fault
    it was when an agent ended early.
    """
    from wildscav_engine.parallel.threads import cores
    from wildscav_evaluator.cli.sessions.rescore import run_rescore
    from wildscav_evaluator.ledger.keys import read_public

    run_rescore(out, jobs or cores(), None if key is None else read_public(key), as_json=as_json)

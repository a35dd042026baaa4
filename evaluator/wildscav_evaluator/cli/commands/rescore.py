"""The command ``wildscav rescore``."""

from pathlib import Path
from typing import Annotated

import typer

from wildscav.cli.shared_options import AsJson
from wildscav_evaluator.cli.options.running import AddressOption, ExecutorOption, executor_of
from wildscav_evaluator.cli.options.signing import KeyOption


def rescore(
    out: Annotated[Path, typer.Argument(help="The output folder of an evaluation.", show_default=False)],
    jobs: Annotated[
        int | None, typer.Option(help="Records to play at once. Default: one per processor core.", min=1)
    ] = None,
    key: KeyOption = None,
    executor: ExecutorOption = "local",
    address: AddressOption = None,
    as_json: AsJson = False,
) -> None:
    """Play every record of an evaluation again and recompute its tables. Exit code 0 only if all agree.

    Every number comes from the records, and every entrant must have exactly the matches of the suite. Only a
    ledger that the organizer signed (--key) proves which submission played, in which sandbox, and whose fault
    it was when an agent ended early.
    """
    from wildscav_evaluator.cli.sessions.rescore import run_rescore
    from wildscav_evaluator.ledger.keys import read_public

    public = None if key is None else read_public(key)
    with executor_of(executor, address, jobs) as machines:
        run_rescore(out, machines, public, as_json=as_json)

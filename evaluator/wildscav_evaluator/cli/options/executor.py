"""The options ``--executor`` and ``--address`` of every command that can use a cluster.

The command line imports this module to show its help, so it imports nothing heavy.
"""

from collections.abc import Collection
from typing import TYPE_CHECKING, Annotated

import typer

from wildscav.cli.shared_options import named_in

if TYPE_CHECKING:
    from wildscav_evaluator.executors import Executor


def _executors() -> Collection[str]:
    from wildscav_evaluator.executors import EXECUTORS

    return EXECUTORS


ExecutorOption = Annotated[
    str,
    typer.Option(
        "--executor",
        **named_in(_executors),
        help="Where the work is done. local: in processes on this machine. ray: on the nodes of a Ray "
        "cluster. Or one that a package adds.",
    ),
]
AddressOption = Annotated[
    str | None,
    typer.Option(
        "--address",
        metavar="ADDRESS",
        help="The Ray cluster for --executor ray: HOST:PORT on one of its nodes, or ray://HOST:PORT from "
        "any other machine. Default: the cluster that runs on this machine, or that RAY_ADDRESS names.",
        show_default=False,
    ),
]


def executor_of(name: str, address: str | None = None, jobs: int | None = None) -> "Executor":
    """Return the executor that the options name, as a context manager.

    Raises:
        UserError: It takes no address, or a package that it needs is not installed.
    """
    from wildscav_evaluator.executors import EXECUTORS

    return EXECUTORS[name](jobs, address)

"""The options ``--executor``, ``--address`` and ``--sandbox``: where agents run, and in what.

The command line imports this module to show its help, so it imports nothing heavy.
"""

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wildscav.cli.shared_options import named_in
from wildscav.errors import UserError

if TYPE_CHECKING:
    from wildscav_evaluator.executors import Executor
    from wildscav_evaluator.model_gateway.settings import ModelSettings
    from wildscav_evaluator.submissions.submission import Submission


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
    """Return the executor that the options name; UserError if it takes no address, or lacks a package."""
    from wildscav_evaluator.executors import EXECUTORS

    return EXECUTORS[name](jobs, address)


def _sandboxes() -> Collection[str]:
    from wildscav_evaluator.sandbox import SANDBOXES

    return SANDBOXES


InSandbox = Annotated[
    str | None,
    typer.Option(
        "--sandbox",
        envvar="WILDSCAV_SANDBOX",
        **named_in(_sandboxes),
        help="How agents run. oci: in containers of Podman or Docker. bubblewrap: in namespaces of their "
        "own. process: as you do, for agents that you trust. Or one that a package adds. Default: the "
        "first of these three that works here.",
        show_default=False,
    ),
]


ModelOption = Annotated[
    Path | None,
    typer.Option(
        "--model",
        metavar="FILE",
        help="File (.toml) that names the server of a language model. Each agent may ask it, by a gateway "
        "that counts its tokens. Default: none.",
        show_default=False,
    ),
]


def chosen_model(file: Path | None, submissions: "Sequence[Submission]") -> "ModelSettings | None":
    """Return the settings of the model that agents may ask.

    UserError if they are not valid, or there are none and a submission plays only with a model.
    """
    if file is None:
        for one in submissions:
            if one.manifest.model:
                need = "asks a language model: add --model FILE, which names its server"
                raise UserError(f"submission {one.name!r} {need}", exit_code=2)
        return None
    from wildscav_evaluator.model_gateway.settings import read_model

    return read_model(file)


def chosen_sandbox(
    asked: str | None, submissions: "Sequence[Submission]", executor: "Executor | None" = None
) -> "tuple[str, tuple[Submission, ...]]":
    """Return the name of the sandbox to use, having printed it, and the submissions as they run in it.

    ``executor`` is where it will be played; this machine if None. SubmissionError if one needs packages and
    was not built, or is an image and the sandbox runs none; SandboxError if the requested sandbox does not
    keep its promises.
    """
    from rich.text import Text

    from wildscav.terminal.console import console
    from wildscav_evaluator.executors.local import LocalExecutor

    with console.status("trying the sandbox"):
        choice, submissions = (executor or LocalExecutor()).choose_sandbox(asked, submissions)
    console.print(f"sandbox   {choice.sandbox.name}")
    for warning in choice.warnings:
        console.print(Text.assemble(("warning: ", "yellow"), warning))
    return choice.sandbox.name, submissions

"""The option ``--sandbox`` of every command that runs agents."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Literal

import typer

if TYPE_CHECKING:
    from wildscav_evaluator.submissions.submission import Submission

InSandbox = Annotated[
    Literal["oci", "bubblewrap", "process"] | None,
    typer.Option(
        "--sandbox",
        envvar="WILDSCAV_SANDBOX",
        help="How agents run. oci: in containers of Podman or Docker. bubblewrap: in namespaces of their "
        "own. process: as you do, for agents that you trust. Default: the first of these that works here.",
        show_default=False,
    ),
]


def chosen_sandbox(
    asked: str | None, submissions: "Sequence[Submission]"
) -> "tuple[str, tuple[Submission, ...]]":
    """Return the name of the sandbox to use, having told it, and the submissions as they run in it.

    Raises:
        SubmissionError: One needs packages and was not built, or is an image and the sandbox runs none.
        SandboxError: The one that is asked for does not keep its promises on this machine.
    """
    from rich.text import Text

    from wildscav.terminal.console import console
    from wildscav_evaluator.sandbox import DEFAULT_LIMITS, SANDBOXES
    from wildscav_evaluator.sandbox.choose import choose
    from wildscav_evaluator.submissions.images import with_images

    with console.status("trying the sandbox"):
        images = any(submission.image for submission in submissions)
        choice = choose(asked, list(SANDBOXES.values()), DEFAULT_LIMITS, images=images)
    console.print(f"sandbox   {choice.sandbox.name}", highlight=False)
    for warning in choice.warnings:
        console.print(Text.assemble(("warning: ", "yellow"), warning), soft_wrap=True)
    return choice.sandbox.name, with_images(submissions, choice.sandbox.name)

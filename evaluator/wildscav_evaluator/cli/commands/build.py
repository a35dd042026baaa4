"""The command ``wildscav build``."""

from pathlib import Path
from typing import Annotated

import typer


def build(
    submission: Annotated[
        Path,
        typer.Argument(
            help="Folder with a submission.toml, an archive of one, or a baseline's name.",
            metavar="SUBMISSION",
            show_default=False,
        ),
    ],
    base: Annotated[
        str | None,
        typer.Option(
            help="Image to build on. Default: the SDK on python:3.11-slim, or on what WILDSCAV_PYTHON_IMAGE "
            "names; built if it does not exist.",
            show_default=False,
        ),
    ] = None,
    dockerfile: Annotated[
        Path | None,
        typer.Option(help="A Dockerfile to use instead of docker/agent.Dockerfile.", show_default=False),
    ] = None,
    build_option: Annotated[
        list[str] | None,
        typer.Option(
            help="Passed on to the engine's build, such as --build-option=--network=host; may be repeated.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Build the container image of a submission, with the packages that its requirements.txt names.

    The build runs the installation code of those packages, with network access: do it where there are no
    secrets. Matches then run the image as it is, without a network.
    """
    from wildscav.terminal.console import console
    from wildscav_evaluator.cli.options.selection import load_named
    from wildscav_evaluator.submissions.images import build_image

    loaded = load_named(submission)
    name = build_image(loaded, base=base, options=build_option or (), dockerfile=dockerfile)
    console.print(f"image     {name}")
    console.print(f"          wildscav play {submission} --sandbox oci")

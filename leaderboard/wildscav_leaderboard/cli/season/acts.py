"""The commands of `wildscav season` that change something, made of the acts: each is in the audit log."""

import getpass
import inspect
from collections.abc import Callable
from datetime import UTC, datetime
from itertools import groupby
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, get_args

import typer
from pydantic import BaseModel

from wildscav.terminal.console import console
from wildscav_leaderboard.cli.season.folders import SeasonFolder, opened
from wildscav_leaderboard.organizing.acts import ACTS, COMMAND_LINE
from wildscav_leaderboard.seasons.acts import Act, Doing

SHORT = {"reason": ["-r"]}  # names of options


def command_line() -> str:
    """Return the actor of acts on this command line: the user of this machine."""
    try:
        return f"{COMMAND_LINE} ({getpass.getuser()})"
    except (OSError, KeyError):  # the system knows no name, such as in a container
        return COMMAND_LINE


def act_commands() -> typer.Typer:
    """Return the commands of all acts."""
    app = typer.Typer()
    named = (one for one in ACTS.values() if one.command)
    for name, acts in groupby(named, lambda one: one.command):
        app.command(name)(_command(list(acts)))
    return app


def _command(acts: list[Act]) -> Callable[..., None]:
    """Return the function of a command: it does an act, or of two acts the one that its argument chooses."""

    def do(folder: Path, **given: Any) -> None:
        act = acts[0]
        if len(acts) > 1:
            what = given.pop("what")
            act = acts[what.isascii() and what.isdigit()]
            given[next(iter(act.fields))] = what
        _do(folder, act, given)

    taken = [_keyword("folder", SeasonFolder), *(_parameter(acts[0], name) for name in acts[0].fields)]
    if len(acts) > 1:
        texts = [str(next(iter(one.fields.values())).description) for one in acts]
        argument = typer.Argument(help=" or ".join(texts), show_default=False)
        taken[1] = _keyword("what", Annotated[str, argument])
    do.__signature__ = inspect.Signature(taken)  # type: ignore[attr-defined]
    do.__annotations__ = {one.name: one.annotation for one in taken}
    do.__doc__ = acts[0].help
    return do


def _parameter(act: Act, name: str) -> inspect.Parameter:
    """Return an argument of a command, or an option."""
    field, parameter = act.fields[name], act.parameters[name]
    about: dict[str, Any] = {"help": field.description, "show_default": not field.is_required()}
    names = [f"--{name}", *SHORT.get(name, [])]
    kind: Any = str
    if parameter.kind is not parameter.KEYWORD_ONLY:
        kind = int if field.annotation is int else str
        return _keyword(name, Annotated[kind, typer.Argument(**about)], parameter.default)
    if act.choices(name):
        first, second = act.choices(name)
        flag = typer.Option(
            f"--{second}", help=field.description, callback=lambda given: (first, second)[given]
        )
        return _keyword(name, Annotated[bool, flag], default=False)
    if NoneType in get_args(field.annotation):
        return _keyword(name, Annotated[int, typer.Option(*names, min=0, **about)], parameter.default)
    if parameter.default is None:
        kind, about["envvar"] = str | None, f"WILDSCAV_{name.upper()}"
    return _keyword(name, Annotated[kind, typer.Option(*names, **about)], parameter.default)


def _keyword(name: str, annotation: Any, default: Any = inspect.Parameter.empty) -> inspect.Parameter:
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, annotation=annotation, default=default)


def _do(folder: Path, act: Act, given: dict[str, Any]) -> None:
    with opened(folder) as (season, database):
        arguments = act.read(given)
        with database.writing() as session:
            result = act.do(Doing(session, season, command_line(), datetime.now(UTC)), arguments)
    lines = [act.says.format(**arguments)] if act.says else []
    if isinstance(result, BaseModel):
        *_, (name, secret) = result.model_dump().items()
        lines += [f"{name} {secret}   (shown this once)" if lines else secret] if secret else []
    for line in lines:
        console.print(line)

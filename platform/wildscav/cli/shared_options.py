"""Options that several commands share."""

import functools
import inspect
from collections.abc import Callable, Collection
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Concatenate, ParamSpec, TypeVar

import typer
from typer.models import ArgumentInfo

from wildscav.errors import UserError
from wildscav.terminal.suggestions import did_you_mean

if TYPE_CHECKING:
    from wildscav_engine.record import Record

Own = ParamSpec("Own")
Shared = TypeVar("Shared")
SOURCES = "wildscav.record_sources"  # entry points: functions such as RecordSource
# Returns the record of a match of a season. Its arguments are the match's number, and the season's address or
# None for the one that the user logged in to.
RecordSource = Callable[[int, str | None], Path]
SeasonOption = Annotated[
    str | None,
    typer.Option(
        help="Address of the season that a number is about. Default: the one that you logged in to last.",
        metavar="URL",
        show_default=False,
    ),
]


def _keep_stdout_free(wanted: bool) -> bool:
    """Print everything else to stderr if stdout is to hold nothing but a JSON document."""
    from wildscav.terminal import console

    console.console.stderr = wanted
    return wanted


AsJson = Annotated[
    bool,
    typer.Option(
        "--json",
        help="Print one JSON document to stdout, and everything else to stderr.",
        callback=_keep_stdout_free,
        show_default=False,
    ),
]


def named_in(registry: Callable[[], Collection[str]]) -> dict[str, Any]:
    """Return settings of an option that takes a name from a registry, which is imported when it is needed."""

    def known(name: str | None) -> str | None:
        if name is not None and name not in (names := registry()):
            choices = ", ".join(map(repr, names))
            raise typer.BadParameter(f"{name!r} is not one of {choices}{did_you_mean(name, names)}")
        return name

    def completions(begun: str) -> list[str]:
        return [name for name in registry() if name.startswith(begun)]

    return {"callback": known, "autocompletion": completions, "metavar": "NAME"}


def takes(
    shared: Callable[..., Shared],
) -> Callable[[Callable[Concatenate[Shared, Own], None]], Callable[..., None]]:
    """Give a command the options that are the fields of a class; the command's first argument is an instance.

    Arguments come before options, and the command's own before the shared ones.
    """

    def decorate(command: Callable[Concatenate[Shared, Own], None]) -> Callable[..., None]:
        own = list(inspect.signature(command).parameters.values())[1:]
        others = inspect.signature(shared).parameters
        signature = inspect.Signature(sorted([*own, *others.values()], key=_is_option))

        @functools.wraps(command)
        def wrapped(*args: Any, **kwargs: Any) -> None:
            bound = signature.bind(*args, **kwargs)
            bound.apply_defaults()
            given = bound.arguments
            command(shared(**{name: given.pop(name) for name in others}), **given)  # type: ignore[call-arg]

        wrapped.__signature__ = signature  # type: ignore[attr-defined]
        wrapped.__annotations__ = {name: one.annotation for name, one in signature.parameters.items()}
        del wrapped.__wrapped__
        return wrapped

    return decorate


def _is_option(parameter: inspect.Parameter) -> bool:
    return not any(isinstance(one, ArgumentInfo) for one in getattr(parameter.annotation, "__metadata__", ()))


def found(record: Path, season: str | None) -> Path:
    """Return the path of a record: as it was named, or of the match that has this number.

    Raises:
        UserError: The number is of no match, nothing can ask for it, or there is a season but no number.
    """
    text = str(record)
    if record.exists() or not (text.isascii() and text.isdigit()):
        if season is not None:
            raise UserError("--season is for the number of a match", exit_code=2)
        return record
    for point in entry_points(group=SOURCES):
        source: RecordSource = point.load()
        return source(int(text), season)
    raise UserError(
        f"match {text} is of a season: install what asks for it: pip install 'wildscav[leaderboard]'"
    )


def read_of_seat(record: Path, option: str, seat: int | None) -> "Record":
    """Read a record, and check that its match has the seat that an option names.

    Raises:
        UserError: It cannot be read, or has no such seat.
    """
    from wildscav_engine.record import RecordError, read_record

    try:
        played = read_record(record)
    except RecordError as error:
        raise UserError(str(error)) from None
    if seat is not None and seat >= len(played.names):
        raise UserError(f"{option} is {seat}; the match has seats 0 to {len(played.names) - 1}", exit_code=2)
    return played

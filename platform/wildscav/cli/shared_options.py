"""Options that several commands share."""

import functools
import inspect
from collections.abc import Callable, Collection
from typing import Annotated, Any, Concatenate, ParamSpec, TypeVar

import typer
from typer.models import ArgumentInfo

from wildscav.terminal.suggestions import did_you_mean

Own = ParamSpec("Own")
Shared = TypeVar("Shared")


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

RulesOption = Annotated[
    str,
    typer.Option(
        "--rules",
        help="original, or fair: agents see with eyes alone, turn in half a second, and shoot well only if "
        "they slow down.",
        metavar="NAME",
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

"""Options that several commands share."""

import functools
import inspect
from collections.abc import Callable
from typing import Any, Concatenate, ParamSpec, TypeVar

from typer.models import ArgumentInfo

Own = ParamSpec("Own")
Shared = TypeVar("Shared")


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

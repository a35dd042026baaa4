"""Tests that are coroutines."""

import asyncio
from collections.abc import Callable, Coroutine, Iterable
from contextlib import AbstractAsyncContextManager
from inspect import Parameter, Signature, signature
from pathlib import Path
from typing import Any, TypeAlias

Test: TypeAlias = Callable[..., Coroutine[Any, Any, None]]
# Opened with a folder and the names of the test's parameters, it yields values of some of them.
Context: TypeAlias = Callable[[Path, list[str]], AbstractAsyncContextManager[dict[str, Any]]]


def within(context: Context, yields: Iterable[str]) -> Callable[[Test], Callable[..., None]]:
    """Make a test of a coroutine, which runs in a context.

    Args:
        yields: What the context may yield, by name. All other parameters of the test are fixtures.
    """

    def decorate(test: Test) -> Callable[..., None]:
        names = [*signature(test).parameters]

        def run(tmp_path: Path, **fixtures: Any) -> None:
            async def whole() -> None:
                async with context(tmp_path, names) as values:
                    known = {**fixtures, "tmp_path": tmp_path, **values}
                    await test(**{name: known[name] for name in names})

            asyncio.run(whole())

        run.__name__, run.__doc__, run.__module__ = test.__name__, test.__doc__, test.__module__
        asked = sorted({"tmp_path", *names}.difference(yields))
        run.__signature__ = Signature(  # type: ignore[attr-defined]
            [Parameter(name, Parameter.POSITIONAL_OR_KEYWORD) for name in asked]
        )
        return run

    return decorate

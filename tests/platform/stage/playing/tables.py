"""Tables that are served for tests, in a thread of their own as a browser's test needs it."""

import asyncio
import threading
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import AsyncExitStack, asynccontextmanager, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from tests.coroutines import Test, within
from tests.platform.stage.playing.pages import page

from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_stage.playing.links import Addresses
from wildscav_stage.playing.plan import Plan, make_plan
from wildscav_stage.playing.site.serve import prepare, served

PAGES: dict[str, Callable[[Addresses], str]] = {  # the link of each
    "person": lambda links: links.host,
    "host": lambda links: links.host,
    "guest": lambda links: links.guests[0],
    "second_guest": lambda links: links.guests[1],
    "spectator": lambda links: links.watch,
    "second_spectator": lambda links: links.watch,
}
MEADOW = MapConfig(size=60, houses=1, relief=0.0, ruggedness=0.0, water=0.0, vegetation=0.0)


def small_plan(
    track: str = "navigation",
    time_limit: float = 60.0,
    opponents: tuple[str, ...] | None = (),
    people: int = 1,
) -> Plan:
    """A match on a small, flat map."""
    plan = make_plan(track, None, 3, opponents, time_limit, people)
    return replace(plan, spec=plan.spec.model_copy(update={"map": MapSpec(config=MEADOW, seed=5)}))


@asynccontextmanager
async def tables_links(
    plan: Plan, folder: Path, public_url: str | None = None, countdown: int = 0, delay: float = 0.0
) -> AsyncIterator[Addresses]:
    """Serve a table, and yield its links."""
    prepare(plan)
    options: Any = {"public_url": public_url, "countdown": countdown, "delay": delay}
    async with served(plan, folder, "127.0.0.1", 0, [].append, **options) as (links, _):
        yield links


@asynccontextmanager
async def table(plan: Plan, folder: Path) -> AsyncIterator[str]:
    """Serve a table, and yield its host's link."""
    async with tables_links(plan, folder) as links:
        yield links.host


def at_table(
    *plan: Any, public_url: str | None = None, countdown: int = 0, delay: float = 0.0, **more: Any
) -> Callable[[Test], Callable[..., None]]:
    """Make a test of a coroutine: it gets the ``PAGES`` that it names, in their order, and ``links``.

    Args:
        plan: As ``small_plan`` takes it, with what ``more`` has.
    """

    @asynccontextmanager
    async def opened(folder: Path, names: list[str]) -> AsyncIterator[dict[str, Any]]:
        asked = small_plan(*plan, **more)
        async with (
            tables_links(asked, folder, public_url, countdown, delay) as links,
            AsyncExitStack() as stack,
        ):
            found: dict[str, Any] = {"links": links}
            for name in (name for name in names if name in PAGES):
                found[name] = await stack.enter_async_context(page(PAGES[name](links)))
            yield found

    return within(opened, ("links", *PAGES))


@contextmanager
def table_in_thread(plan: Plan, folder: Path) -> Iterator[Addresses]:
    """Serve a table in a thread, and yield its links."""
    found: list[Any] = []
    ready = threading.Event()

    async def serve() -> None:
        end = asyncio.Event()
        try:
            async with tables_links(plan, folder) as links:
                found.extend((links, asyncio.get_running_loop(), end))
                ready.set()
                await end.wait()
        finally:
            ready.set()

    thread = threading.Thread(target=asyncio.run, args=(serve(),))
    thread.start()
    ready.wait()
    links, loop, end = found
    try:
        yield links
    finally:
        loop.call_soon_threadsafe(end.set)
        thread.join()

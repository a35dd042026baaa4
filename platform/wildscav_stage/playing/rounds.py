"""One match of a table: hosted by the match server, played by people and submissions, and recorded."""

import asyncio
import time
from collections.abc import AsyncIterator, Callable, Coroutine, Mapping, Sequence
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from wildscav_engine.record import SUFFIX, write_record
from wildscav_server.hosting.opponents import playing
from wildscav_server.match_server import MatchServer
from wildscav_server.time_limits import Clock
from wildscav_stage.playing.lobby import Person
from wildscav_stage.playing.plan import Plan
from wildscav_stage.playing.shooting_range import targets_playing

if TYPE_CHECKING:
    from wildscav_engine.specs.match_spec import MatchSpec
    from wildscav_server.hosting.hosted_match import HostedMatch

LONGEST_PAUSE = 86_400.0  # s, of a match against robots alone, which wait for the person
ROBOT_CLOCK = Clock(time_bank=LONGEST_PAUSE, idle_limit=LONGEST_PAUSE, paused_bank=LONGEST_PAUSE)


# Runs the submissions of a match for as long as the block lasts, given: the folder of each seat that has one,
# the match, where each of these seats is joined, which nobody else can, and the folder for what agents print.
Agents: TypeAlias = Callable[
    [Mapping[int, Path], "HostedMatch", Mapping[int, str], Path], AbstractAsyncContextManager[None]
]


class MatchHosting(NamedTuple):
    """Where matches are played."""

    server: MatchServer
    address: str  # where people join
    seats: Mapping[int, str]  # where the submission of each seat that has one joins
    folder: Path  # for records, and for the output of agents
    agents: Agents = playing  # runs submissions


@asynccontextmanager
async def hosted_match(
    hosting: MatchHosting, plan: Plan, spec: "MatchSpec", names: Sequence[str]
) -> AsyncIterator["HostedMatch"]:
    """Host a match within the block, and run the submissions that play in it."""
    opponents = dict(enumerate(plan.opponents, start=plan.people))
    hosted = await hosting.server.host(
        spec,
        names=names,
        sensors={seat: each.sensors for seat, each in opponents.items() if each.sensors},
        seeds=None if plan.given is None else {0: plan.given.seed},
        clock=ROBOT_CLOCK if plan.may_pause else Clock(),
        addresses=hosting.seats,
    )
    folders = {seat: each.folder for seat, each in opponents.items() if each.folder is not None}
    try:
        hosting.folder.mkdir(parents=True, exist_ok=True)
        async with (
            hosting.agents(folders, hosted, hosting.seats, hosting.folder),
            targets_playing(hosted, hosting.address, plan.targets),
        ):
            yield hosted
    finally:
        hosted.cancel()  # does nothing after its end


async def play_out(
    hosting: MatchHosting,
    hosted: "HostedMatch",
    people: Mapping[int, Person],
    noted: Callable[[], None],
    path: Path | None = None,
) -> Path:
    """Let people, by their seats, play a match to its end, and return its record: the path, or a free one.

    ``noted`` is called after each frame.
    """
    # The seats are joined at the same time, because the match begins when all are.
    joined = (
        person.play(hosted.match, hosting.address, hosted.tokens[seat], noted)
        for seat, person in people.items()
    )
    await asyncio.gather(*joined)
    match = (await hosted.finished()).match
    path = path or _free_path(hosting.folder, match.spec.track)
    await asyncio.to_thread(write_record, path, match, hosted.names)
    return path


@asynccontextmanager
async def beside(work: Coroutine[Any, Any, None]) -> AsyncIterator[None]:
    """Do a work that has no end for as long as the block lasts."""
    task = asyncio.create_task(work)
    try:
        yield
    finally:
        task.cancel()
        (ended,) = await asyncio.gather(task, return_exceptions=True)
    if isinstance(ended, Exception):
        raise ended


def _free_path(folder: Path, track: str) -> Path:
    """Return a path for a record, another one if a match ended in the same second."""
    stem = f"{track}-{time.strftime('%Y%m%d-%H%M%S')}"
    names = (f"{stem}{f'-{number}' if number > 1 else ''}{SUFFIX}" for number in range(1, 1000))
    return next(path for path in (folder / name for name in names) if not path.exists())

"""Submissions that play against people: each a process that joins its seat, as anybody's agent does."""

import asyncio
import os
import sys
from collections.abc import AsyncIterator, Mapping
from contextlib import AbstractAsyncContextManager, AsyncExitStack, asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from wildscav.sdk.run import ADDRESS_VARIABLE, TOKEN_VARIABLE

if TYPE_CHECKING:
    from wildscav.server import HostedMatch

END_TIME = 3.0  # s for an agent to end when the match is over


class Agents(Protocol):
    """Runs the submissions of a match for as long as the block lasts."""

    def __call__(
        self, folders: Mapping[int, Path], hosted: "HostedMatch", addresses: Mapping[int, str], logs: Path
    ) -> AbstractAsyncContextManager[None]:
        """Run them.

        Args:
            folders: The submission's folder of each seat that has one.
            hosted: The match.
            addresses: Where each of these seats is joined, which nobody else can.
            logs: The folder for what agents print.
        """


@asynccontextmanager
async def playing(
    folders: Mapping[int, Path], hosted: "HostedMatch", addresses: Mapping[int, str], logs: Path
) -> AsyncIterator[None]:
    """Run submissions without a sandbox; whoever starts them trusts their code. See ``Agents``."""
    async with AsyncExitStack() as stack:
        for seat, folder in folders.items():
            log = logs / f"{seat}-{hosted.names[seat].replace(' ', '-')}.log"
            await stack.enter_async_context(_agent(seat, folder, hosted, addresses[seat], log))
        yield


@asynccontextmanager
async def _agent(
    seat: int, folder: Path, hosted: "HostedMatch", address: str, log: Path
) -> AsyncIterator[None]:
    own = {ADDRESS_VARIABLE: address, TOKEN_VARIABLE: hosted.tokens[seat]}
    with log.open("wb") as file:
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "wildscav.sdk", str(folder)),
            env=os.environ | own,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=file,
            stderr=file,
        )
    watching = asyncio.create_task(_watch(process, seat, hosted, log))
    try:
        yield
    finally:
        try:
            await asyncio.wait_for(process.wait(), END_TIME)
        except TimeoutError:
            process.kill()
        await watching


async def _watch(process: asyncio.subprocess.Process, seat: int, hosted: "HostedMatch", log: Path) -> None:
    """Let the match go on without an agent whose process ends early."""
    code = await process.wait()
    hosted.give_up(seat, f"its process ended with exit code {code}; its output is in {log}")

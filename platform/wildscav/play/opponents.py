"""Submissions that play against people: each a process that joins its seat, as anybody's agent does."""

import asyncio
import os
import sys
from collections.abc import AsyncIterator, Mapping
from contextlib import AsyncExitStack, asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from wildscav.sdk.run import ADDRESS_VARIABLE, TOKEN_VARIABLE

if TYPE_CHECKING:
    from wildscav.server import HostedMatch

END_TIME = 3.0  # s for an agent to end when the match is over


@asynccontextmanager
async def playing(
    folders: Mapping[int, Path], hosted: "HostedMatch", address: str, logs: Path
) -> AsyncIterator[None]:
    """Run the submissions of a match, without a sandbox; whoever starts them trusts their code.

    Args:
        folders: The submission's folder of each seat that has one.
        hosted: The match.
        address: Where its seats are joined.
        logs: The folder for what agents print.
    """
    async with AsyncExitStack() as stack:
        for seat, folder in folders.items():
            log = logs / f"{seat}-{hosted.names[seat].replace(' ', '-')}.log"
            await stack.enter_async_context(_agent(seat, folder, hosted, address, log))
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

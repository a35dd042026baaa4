"""Who else plays in a match that somebody starts by hand: submissions as plain processes, under names."""

import asyncio
import os
import sys
from collections.abc import AsyncIterator, Mapping, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wildscav.errors import UserError
from wildscav.sdk.run import ADDRESS_VARIABLE, TOKEN_VARIABLE
from wildscav.sdk.submission_folder import MANIFEST
from wildscav_server.hosting.manifest import check_plays_numbers, read_manifest

if TYPE_CHECKING:
    from wildscav_server.hosting.hosted_match import HostedMatch

END_TIME = 3.0  # s for an agent to end when the match is over


@dataclass(frozen=True)
class Opponent:
    """Who plays in another seat than those of whoever starts the match."""

    name: str
    folder: Path | None = None  # of a submission; None for a robot
    sensors: Mapping[str, Mapping[str, Any]] | None = None  # of a submission


def submission_opponent(folder: Path, track: str) -> Opponent:
    """Return the opponent that plays from a submission's folder.

    Raises:
        UserError: It cannot be read, does not play the track, plays by another interface than numbers, or
            asks a model.
    """
    manifest = read_manifest(folder / MANIFEST)
    if track not in manifest.tracks:
        raise UserError(
            f"{manifest.name} does not play {track}; it plays {', '.join(manifest.tracks)}", exit_code=2
        )
    check_plays_numbers(folder / MANIFEST, manifest)
    return Opponent(manifest.name, folder.absolute(), manifest.sensors)


def numbered(names: Sequence[str]) -> tuple[str, ...]:
    """Return names of which those that occur several times are numbered, so that all are different."""
    taken, chosen = set(names), []
    for name in names:
        own, number = name, 0
        while names.count(name) > 1 and (own in taken or own == name):
            number += 1
            own = f"{name} {number}"
        taken.add(own)
        chosen.append(own)
    return tuple(chosen)


@asynccontextmanager
async def playing(
    folders: Mapping[int, Path], hosted: "HostedMatch", addresses: Mapping[int, str], logs: Path
) -> AsyncIterator[None]:
    """Run submissions within the block, without a sandbox; whoever starts them trusts their code."""
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

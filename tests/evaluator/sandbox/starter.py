"""A program that starts agents in a sandbox, to be killed by tests: its arguments are those of ``main``."""

import asyncio
import sys
from pathlib import Path

from wildscav_evaluator.sandbox import SANDBOXES, Launch
from wildscav_evaluator.sandbox.containers import wall_clock
from wildscav_server import leftovers


async def main(sandbox: str, folder: str, address: str, log: str, how: str = "once") -> None:
    """Print the name of this owner, and start an agent once, again and again, or unwatched.

    Unwatched, it is a container with a wall clock of so many seconds; that of this program leaves it alone.
    """
    print(leftovers.owner(), flush=True)  # noqa: T201
    lasts = 600.0
    if how not in ("once", "again"):
        wall_clock.LATER = float(how) - lasts
    launch = Launch(Path(folder), "agent:Player", address, "of the seat", Path(log), lasts=lasts)
    while True:
        agent = await SANDBOXES[sandbox].start(launch)
        await (asyncio.sleep(0.2) if how == "again" else agent.ended())
        await agent.stop()
        if how != "again":
            return


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))

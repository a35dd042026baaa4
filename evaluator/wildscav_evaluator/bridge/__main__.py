"""The process of a bridge, for all of its match's seats that play by words or keys.

The first line of its standard input has the orders. It serves until its standard input ends, as it does when
the evaluator is gone, and then exits with code 0. Any other exit code is a fault of the platform.
"""

import asyncio
import json
import sys
from typing import Any

from wildscav.sdk.run import use_batch_scheduling
from wildscav_evaluator.bridge.desk import Order
from wildscav_evaluator.bridge.seat import SeatBridge

MOST_ORDERED = 1_000_000  # bytes of the orders


async def serve() -> None:
    """Serve the seats that are ordered until the standard input ends, or the bridge fails."""
    loop = asyncio.get_running_loop()
    failed: asyncio.Future[Any] = loop.create_future()
    orders = asyncio.StreamReader(MOST_ORDERED)
    await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(orders), sys.stdin)
    for order in json.loads(await orders.readline()):
        await SeatBridge(Order(**order), failed).listen()
    ended: asyncio.Future[Any] = asyncio.create_task(orders.read())
    await asyncio.wait((failed, ended), return_when=asyncio.FIRST_COMPLETED)
    if failed.done():
        failed.result()


if __name__ == "__main__":
    use_batch_scheduling()
    asyncio.run(serve())

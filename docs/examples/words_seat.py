"""Host a match, take its seat of words, and walk to the target."""

import asyncio
from pathlib import Path
from tempfile import TemporaryDirectory

from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_language.rules_text import rules
from wildscav_language.seat import Seat
from wildscav_language.senses import sensors
from wildscav_server.match_server import MatchServer

MAP = MapSpec(config=MapConfig(size=60), seed=1)
SPEC = MatchSpec(track="navigation", map=MAP, seed=1, clock="paused")


async def main(folder: Path) -> None:
    """Play a navigation, and print its metrics."""
    server = MatchServer()
    (address,) = await server.start([f"unix:{folder / 'match.sock'}"])
    hosted = await server.host(SPEC, names=["Reader"], sensors={0: sensors()})
    seat = Seat(hosted.names)  # the names of all seats
    playing = asyncio.create_task(asyncio.to_thread(seat.play, address, hosted.tokens[0]))
    print(await asyncio.to_thread(seat.observe))
    print(rules(seat.match))
    while not seat.is_over:
        reply = await asyncio.to_thread(seat.call, "go", {"place": "target", "seconds": 20.0})
        print(reply.ended, reply.steps)
    await playing
    print((await hosted.finished()).match.result().seats[0].metrics)
    await server.stop()


with TemporaryDirectory() as folder:
    asyncio.run(main(Path(folder)))

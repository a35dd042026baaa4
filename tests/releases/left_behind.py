"""What a release leaves behind, for the tests of those that follow.

    python -m tests.releases.left_behind

makes it of this version, in a folder of its name: a battle of the baseline `hunter`, with all messages
between the agent and the server, the baseline itself, a season of three teams that have played, and the
description of the API.
"""

import base64
import json
import lzma
import tarfile
import tempfile
from pathlib import Path
from typing import Any

import grpc
from google.protobuf.descriptor_pb2 import FileDescriptorProto
from tests.leaderboard.played_seasons import play_season
from tests.platform.helpers.seats import serving, start_agent

from wildscav.proto import match_pb2
from wildscav.version import __version__
from wildscav_engine.record import write_record
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_leaderboard.hosting.app import create_app
from wildscav_leaderboard.seasons.folder import Season
from wildscav_server.match_server import MatchServer

OUT = Path(__file__).with_name(__version__)
HUNTER = Path(__file__).parents[2] / "submissions" / "hunter"
PLAY = "/wildscav.match.v1.Match/Play"
SPEC = MatchSpec(
    track="battle",
    map=MapSpec(config=MapConfig(size=60, houses=1, density="low"), seed=5),
    seed=7,
    seats=("submission", "fighter", "gatherer"),
    time_limit=10.0,
)


class Tap(grpc.GenericRpcHandler):
    """Passes on what an agent and a match server say to each other, and keeps it."""

    def __init__(self, address: str) -> None:
        self.channel = grpc.aio.insecure_channel(address)
        self.messages: list[tuple[str, str]] = []

    def service(self, details: grpc.HandlerCallDetails) -> Any:
        """Return the one method that there is."""
        return grpc.stream_stream_rpc_method_handler(self.play)

    async def play(self, messages: Any, context: Any) -> Any:
        """Pass messages on, in turns, as a match with a paused clock has them."""
        call = self.channel.stream_stream(PLAY)()
        async for message in messages:
            self._keep("client", message)
            await call.write(message)
            answer = await call.read()
            if answer is grpc.aio.EOF:
                return
            self._keep("server", answer)
            yield answer

    def _keep(self, who: str, message: bytes) -> None:
        self.messages.append((who, base64.b64encode(message).decode()))


async def play(server: MatchServer, address: str) -> Tap:
    """Let `hunter` play, and write the record."""
    hosted = await server.host(SPEC, names=("hunter", "fighter", "gatherer"))
    tap, ears = Tap(address), grpc.aio.server()
    ears.add_generic_rpc_handlers((tap,))
    port = ears.add_insecure_port("127.0.0.1:0")
    await ears.start()
    agent = await start_agent("agent:Hunter", f"127.0.0.1:{port}", hosted.tokens[0], HUNTER)
    await hosted.finished()
    await agent.wait()
    await ears.stop(None)
    await tap.channel.close()
    write_record(OUT / "match.wsr", hosted.match, hosted.names)
    return tap


def write_json(name: str, values: Any) -> None:
    """Write values as JSON, compressed."""
    (OUT / f"{name}.json.xz").write_bytes(lzma.compress(json.dumps(values).encode()))


def write_folder(folder: Path) -> None:
    """Write a folder as an archive."""

    def kept(one: tarfile.TarInfo) -> tarfile.TarInfo | None:
        one.uid = one.gid = 0
        one.uname = one.gname = ""
        return None if "__pycache__" in one.name else one

    with tarfile.open(OUT / f"{folder.name}.tar.xz", "w:xz") as archive:
        archive.add(folder, folder.name, filter=kept)


def main() -> None:
    """Make all files."""
    OUT.mkdir()
    with tempfile.TemporaryDirectory() as made:
        tap = serving(Path(made), play)
        protocol = FileDescriptorProto()
        match_pb2.DESCRIPTOR.CopyToProto(protocol)
        descriptor = base64.b64encode(protocol.SerializeToString()).decode()
        spec = SPEC.model_dump(mode="json")
        write_json("client", {"spec": spec, "descriptor": descriptor, "messages": tap.messages})
        write_folder(HUNTER)
        play_season(Path(made))
        write_folder(Path(made) / "season")
        season = Season.open(Path(made) / "season")
        database = season.database()
        app = create_app(season, database)
        write_json("openapi", app.openapi())
        app.state.renders.close()
        database.close()


if __name__ == "__main__":
    main()

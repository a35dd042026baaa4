"""What earlier releases left behind still works: a record, the messages of an agent, a season, and the API.

Each release made its own files, as `left_behind.py` does.
"""

import base64
import json
import lzma
import tarfile
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

import grpc
import pytest
from google.protobuf.descriptor_pb2 import FileDescriptorProto
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message import Message
from google.protobuf.message_factory import GetMessageClass
from sqlalchemy import func, select
from tests.platform.helpers.seats import ended, serving, start_agent

from wildscav.proto import match_pb2
from wildscav_engine.maps import GENERATOR_VERSION
from wildscav_engine.record import read_record, record_of, verify_record
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.version import SIMULATION_VERSION
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.boards.service import refresh
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.hosting.app import create_app
from wildscav_leaderboard.matches.models import FINISHED, Match
from wildscav_leaderboard.seasons.folder import Season
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.match_server import MatchServer

RELEASES = sorted(folder.name for folder in Path(__file__).parent.glob("[0-9]*"))
PLAYED = 24  # matches of the season
# What its API had, and has no more. Pictures of matches from above: browsers draw them.
GONE = {"0.1.0": ["get /api/v1/matches/{match}/overview.webp"]}
LATER = datetime(2030, 6, 2, tzinfo=UTC)  # than all of its matches


class Release:
    """What one release left behind."""

    def __init__(self, version: str) -> None:
        self.version = version
        self.files = Path(__file__).with_name(version)
        self.record = read_record(self.files / "match.wsr")
        client = self.json("client")
        self.spec = MatchSpec.model_validate(client["spec"])
        self.protocol = FileDescriptorProto.FromString(base64.b64decode(client["descriptor"]))
        self.messages = [(who, base64.b64decode(text)) for who, text in client["messages"]]

    @property
    def plays_the_same(self) -> bool:
        """Whether a match is still the same, to the bit."""
        versions = (self.record.simulation_version, self.record.generator_version)
        return versions == (SIMULATION_VERSION, GENERATOR_VERSION)

    def json(self, name: str) -> Any:
        return json.loads(lzma.decompress((self.files / f"{name}.json.xz").read_bytes()))

    def said_by(self, who: str) -> list[bytes]:
        return [message for one, message in self.messages if one == who]

    def message(self, name: str) -> type[Message]:
        """Return a message as that release knows it."""
        pool = DescriptorPool()
        pool.Add(self.protocol)
        return GetMessageClass(pool.FindMessageTypeByName(f"{self.protocol.package}.{name}"))

    def unpack(self, name: str, folder: Path) -> None:
        with tarfile.open(self.files / name) as archive:
            archive.extractall(folder, filter="data")


@pytest.fixture(params=RELEASES)
def release(request: pytest.FixtureRequest) -> Release:
    return Release(request.param)


def test_its_record_is_read_and_played_again(release: Release) -> None:
    version, record = release.version, release.record
    assert (record.engine_version, record.names) == (version, ("hunter", "fighter", "gatherer"))
    found = verify_record(record)
    assert found.holds is release.plays_the_same, found.message
    reasons = ("at another commit", f"play it with release {version}")
    assert found.holds or any(reason in found.message for reason in reasons)


def test_every_field_of_its_protocol_is_as_it_was(release: Release) -> None:
    now = FileDescriptorProto()
    match_pb2.DESCRIPTOR.CopyToProto(now)
    messages = {
        message.name: {field.number: field for field in message.field} for message in now.message_type
    }
    for message in release.protocol.message_type:
        for field in message.field:
            assert messages[message.name].get(field.number) == field, f"{message.name}.{field.name}"


def test_its_client_plays_the_same_match_and_reads_the_same_answers(release: Release, tmp_path: Path) -> None:
    digests, answers = serving(tmp_path, partial(play_as_recorded, release))

    server_message = release.message("ServerMessage")
    read, expected = (
        [comparable(server_message.FromString(data)) for data in answers_of]
        for answers_of in (answers, release.said_by("server"))
    )
    assert len(read) == len(expected)
    assert read[-1].HasField("match_over")
    if release.plays_the_same:
        assert read == expected
        assert digests == release.record.digests.tolist()


async def play_as_recorded(
    release: Release, server: MatchServer, address: str
) -> tuple[list[int], list[bytes]]:
    """Send what the client sent; return the digests of the match, and what the server answered."""
    hosted = await server.host(release.spec, names=release.record.names)
    join, *others = release.said_by("client")
    first: Any = release.message("ClientMessage").FromString(join)
    first.join.token = hosted.tokens[0]
    answers = []
    async with grpc.aio.insecure_channel(address) as channel:
        call = channel.stream_stream("/wildscav.match.v1.Match/Play")()  # of bytes, as nothing converts them
        for message in (first.SerializeToString(), *others):
            await call.write(message)
            answers.append(await call.read())
    await hosted.finished()
    return record_of(hosted.match, hosted.names).digests.tolist(), answers


def test_its_submission_plays_with_this_sdk(release: Release, tmp_path: Path) -> None:
    release.unpack("hunter.tar.xz", tmp_path)

    async def play(server: MatchServer, address: str) -> SeatStatus:
        hosted = await server.host(release.spec, names=release.record.names)
        agent = await start_agent("agent:Hunter", address, hosted.tokens[0], tmp_path / "hunter")
        outcome = await hosted.finished()
        assert await ended(agent) == (0, "")
        return outcome.seats[0].status

    assert serving(tmp_path, play) is SeatStatus.FINISHED


def comparable(message: Any) -> Any:
    """Return a message without what newer releases tell besides, and without measured times."""
    message.DiscardUnknownFields()
    if message.HasField("observation"):
        message.observation.ClearField("time_bank")
    if message.HasField("match_over"):
        message.match_over.ClearField("conduct")
    return message


@pytest.fixture
def season(release: Release, tmp_path: Path) -> Season:
    release.unpack("season.tar.xz", tmp_path)
    return Season.open(tmp_path / "season")


@pytest.fixture
def database(season: Season) -> Any:
    opened = season.database()
    yield opened
    opened.close()


def test_its_season_is_migrated_and_its_boards_stay(
    release: Release, season: Season, database: Database
) -> None:
    database.upgrade()

    with database.writing() as session:
        assert session.scalar(select(func.count()).select_from(Match).filter_by(state=FINISHED)) == PLAYED
        for track in season.settings.tracks:
            before = read_board(session, track)
            assert before
            assert {row.team for row in before.rows if row.submission} == {"foxes", "owls", "hares"}
            refresh(session, season, LATER)
            after = read_board(session, track)
            assert after
            assert after.rows == before.rows
    records = sorted(season.folder.rglob("*.wsr"))
    assert len(records) == PLAYED
    assert all(read_record(file).engine_version == release.version for file in records)


def test_every_request_that_its_api_answered_is_answered_with_the_same_fields(
    release: Release, season: Season, database: Database
) -> None:
    database.upgrade()
    app = create_app(season, database)
    now, then = app.openapi(), release.json("openapi")
    app.state.renders.close()

    gone = [
        f"{method} {path}"
        for path in then["paths"]
        for method in then["paths"][path]
        if method not in now["paths"].get(path, ())
    ]
    assert gone == GONE.get(release.version, [])
    for name, schema in then["components"]["schemas"].items():
        fields = set(schema.get("properties", ()))
        assert fields - set(now["components"]["schemas"].get(name, {}).get("properties", ())) == set(), name

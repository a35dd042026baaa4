"""What release 0.1.0 left behind still works: a record, the messages of an agent, a season, and its API.

That release made the files: a battle of its baseline `hunter`, with all messages between the agent and the
server, the baseline itself, a season of three teams that have played, and the description of the API.
"""

import base64
import json
import lzma
import tarfile
from datetime import UTC, datetime
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

FILES = Path(__file__).with_name("0.1.0")
RECORD = read_record(FILES / "match.wsr")
CLIENT: dict[str, Any] = json.loads(lzma.decompress((FILES / "client.json.xz").read_bytes()))
# As long as these are its own: then a match is still the same, to the bit.
PLAYS_THE_SAME = (RECORD.simulation_version, RECORD.generator_version) == (
    SIMULATION_VERSION,
    GENERATOR_VERSION,
)
PLAYED = 24  # matches of the season
# Pictures of matches from above: browsers draw them.
GONE = ["get /api/v1/matches/{match}/overview.webp"]
LATER = datetime(2030, 6, 2, tzinfo=UTC)  # than all of its matches
OLD_PROTOCOL = FileDescriptorProto.FromString(base64.b64decode(CLIENT["descriptor"]))


def said_by(who: str) -> list[bytes]:
    return [base64.b64decode(text) for name, text in CLIENT["messages"] if name == who]


def old_class(name: str) -> type[Message]:
    """Return a message as that release knows it."""
    pool = DescriptorPool()
    pool.Add(OLD_PROTOCOL)
    return GetMessageClass(pool.FindMessageTypeByName(f"{OLD_PROTOCOL.package}.{name}"))


def test_its_record_is_read_and_played_again() -> None:
    assert (RECORD.engine_version, RECORD.names) == ("0.1.0", ("hunter", "fighter", "gatherer"))
    found = verify_record(RECORD)
    assert found.holds is PLAYS_THE_SAME, found.message
    assert (
        found.holds or "at another commit" in found.message or "play it with release 0.1.0" in found.message
    )


def test_every_field_of_its_protocol_is_as_it_was() -> None:
    now = FileDescriptorProto()
    match_pb2.DESCRIPTOR.CopyToProto(now)
    messages = {
        message.name: {field.number: field for field in message.field} for message in now.message_type
    }
    for message in OLD_PROTOCOL.message_type:
        for field in message.field:
            assert messages[message.name].get(field.number) == field, f"{message.name}.{field.name}"


def test_its_client_plays_the_same_match_and_reads_the_same_answers(tmp_path: Path) -> None:
    digests, answers = serving(tmp_path, play_as_recorded)

    server_message = old_class("ServerMessage")
    read, expected = (
        [comparable(server_message.FromString(data)) for data in answers_of]
        for answers_of in (answers, said_by("server"))
    )
    assert len(read) == len(expected)
    assert read[-1].HasField("match_over")
    if PLAYS_THE_SAME:
        assert read == expected
        assert digests == RECORD.digests.tolist()


async def play_as_recorded(server: MatchServer, address: str) -> tuple[list[int], list[bytes]]:
    """Send what the client sent; return the digests of the match, and what the server answered."""
    hosted = await server.host(MatchSpec.model_validate(CLIENT["spec"]), names=RECORD.names)
    join, *others = said_by("client")
    first: Any = old_class("ClientMessage").FromString(join)
    first.join.token = hosted.tokens[0]
    answers = []
    async with grpc.aio.insecure_channel(address) as channel:
        call = channel.stream_stream("/wildscav.match.v1.Match/Play")()  # of bytes, as nothing converts them
        for message in (first.SerializeToString(), *others):
            await call.write(message)
            answers.append(await call.read())
    await hosted.finished()
    return record_of(hosted.match, hosted.names).digests.tolist(), answers


def test_its_submission_plays_with_this_sdk(tmp_path: Path) -> None:
    unpack("hunter.tar.xz", tmp_path)

    async def play(server: MatchServer, address: str) -> SeatStatus:
        hosted = await server.host(MatchSpec.model_validate(CLIENT["spec"]), names=RECORD.names)
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


def unpack(name: str, folder: Path) -> None:
    with tarfile.open(FILES / name) as archive:
        archive.extractall(folder, filter="data")


@pytest.fixture
def season(tmp_path: Path) -> Season:
    unpack("season.tar.xz", tmp_path)
    return Season.open(tmp_path / "season")


@pytest.fixture
def database(season: Season) -> Any:
    opened = season.database()
    yield opened
    opened.close()


def test_its_season_is_migrated_and_its_boards_stay(season: Season, database: Database) -> None:
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
    assert all(read_record(file).engine_version == "0.1.0" for file in records)


def test_every_request_that_its_api_answered_is_answered_with_the_same_fields(
    season: Season, database: Database
) -> None:
    database.upgrade()
    app = create_app(season, database)
    now, then = app.openapi(), json.loads(lzma.decompress((FILES / "openapi.json.xz").read_bytes()))
    app.state.renders.close()

    gone = [
        f"{method} {path}"
        for path in then["paths"]
        for method in then["paths"][path]
        if method not in now["paths"].get(path, ())
    ]
    assert gone == GONE
    for name, schema in then["components"]["schemas"].items():
        fields = set(schema.get("properties", ()))
        assert fields - set(now["components"]["schemas"].get(name, {}).get("properties", ())) == set(), name

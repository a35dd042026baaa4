"""What the server refuses, and how it says so."""

from pathlib import Path

import grpc
import pytest
from grpc_health.v1 import health_pb2, health_pb2_grpc
from tests.platform.seats import HandPlayed, connected, ended, host, serving, small_spec, start_agent

from wildscav.errors import AddressInUseError, SensorError, UserError
from wildscav.proto.match_pb2 import ClientMessage
from wildscav.server import MatchServer, SeatStatus
from wildscav.wire.errors import reason_of


async def refused(seat: HandPlayed) -> tuple[grpc.StatusCode, str]:
    """Read to the end of a stream; return its status and the reason in its details."""
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        await seat.read_out()
    return caught.value.code(), reason_of(caught.value)


def test_a_wrong_token(tmp_path: Path) -> None:
    async def play(server: MatchServer, address: str) -> None:
        agent = await start_agent("Walker", address, "no-such-token")
        code, errors = await ended(agent)
        assert code == 4
        assert "no seat here has this token (SEAT_TOKEN_UNKNOWN)" in errors

    serving(tmp_path, play)


def test_a_seat_cannot_be_taken_twice(tmp_path: Path) -> None:
    async def play(server: MatchServer, address: str) -> None:
        hosted = await host(server, small_spec())
        async with connected(address) as first, connected(address) as second:
            await first.join(hosted.tokens[0])
            await second.send(join(hosted.tokens[0]))
            assert await refused(second) == (grpc.StatusCode.ALREADY_EXISTS, "SEAT_TAKEN")
            assert (await first.play_out()).match_over.conduct.status == SeatStatus.FINISHED

    serving(tmp_path, play)


def test_another_version_of_the_protocol(tmp_path: Path) -> None:
    async def play(server: MatchServer, address: str) -> None:
        hosted = await host(server, small_spec())
        async with connected(address) as seat:
            await seat.send(join(hosted.tokens[0], version=2))
            assert await refused(seat) == (grpc.StatusCode.FAILED_PRECONDITION, "PROTOCOL_VERSION")
        async with connected(address) as seat:  # the seat is still free
            await seat.join(hosted.tokens[0])
            await seat.play_out()

    serving(tmp_path, play)


def join(token: str, version: int = 1) -> ClientMessage:
    message = ClientMessage()
    message.join.token = token
    message.join.protocol_version = version
    return message


def action(step: int) -> ClientMessage:
    message = ClientMessage()
    message.action.step = step
    return message


@pytest.mark.parametrize(
    ("nonsense", "detail"),
    [
        ([b"\xff\xff\xff"], "no ClientMessage"),
        ([ClientMessage()], "must be an Action"),
        ([join("again")], "must be an Action"),
        ([action(7)], "before it was asked"),
        ([action(0)] * 17, "old answers"),
    ],
    ids=["garbage", "empty", "second join", "future step", "flood"],
)
def test_a_seat_that_talks_nonsense_is_out_and_the_others_play_on(
    tmp_path: Path, nonsense: list[ClientMessage | bytes], detail: str
) -> None:
    async def play(server: MatchServer, address: str) -> None:
        hosted = await host(server, small_spec(seats=2))
        async with connected(address) as bad, connected(address) as good:
            await bad.join(hosted.tokens[0])
            await good.join(hosted.tokens[1])
            await bad.read()
            for message in nonsense:
                await bad.send(message)
            await good.play_out(walk_speed=3.0)
            assert await refused(bad) == (grpc.StatusCode.INVALID_ARGUMENT, "PROTOCOL_ERROR")
        outcome = await hosted.finished()
        assert outcome.seats[0].status == SeatStatus.PROTOCOL_ERROR
        assert detail in outcome.seats[0].detail
        assert (outcome.seats[1].status, outcome.seats[1].steps_played) == (SeatStatus.FINISHED, 20)
        assert outcome.seconds < 5.0

    serving(tmp_path, play)


@pytest.mark.parametrize("first", [b"\xff\xff", action(0)], ids=["garbage", "action"])
def test_a_stream_begins_with_a_join(tmp_path: Path, first: ClientMessage | bytes) -> None:
    async def play(server: MatchServer, address: str) -> None:
        async with connected(address) as stranger:
            await stranger.send(first)
            assert await refused(stranger) == (grpc.StatusCode.INVALID_ARGUMENT, "PROTOCOL_ERROR")

    serving(tmp_path, play)


def test_a_huge_message_costs_its_seat_alone(tmp_path: Path) -> None:
    async def play(server: MatchServer, address: str) -> None:
        hosted = await host(server, small_spec(seats=2))
        async with connected(address) as bad, connected(address) as good:
            await bad.join(hosted.tokens[0])
            await good.join(hosted.tokens[1])
            await bad.read()
            await bad.send(b"\0" * 1_000_000)
            await good.play_out()
        outcome = await hosted.finished()
        assert outcome.seats[0].status in {SeatStatus.CRASHED, SeatStatus.PROTOCOL_ERROR}
        assert outcome.seats[1].steps_played == 20
        assert outcome.seconds < 5.0

    serving(tmp_path, play)


def test_sensors_and_names_are_checked(tmp_path: Path) -> None:
    async def play(server: MatchServer, address: str) -> None:
        with pytest.raises(SensorError, match="no sensor 'sonar'; the sensors are depth"):
            await host(server, small_spec(), sensors={0: {"sonar": {}}})
        with pytest.raises(SensorError, match="width"):
            await host(server, small_spec(), sensors={0: {"depth": {"width": -1}}})
        with pytest.raises(ValueError, match="seat 3"):
            await host(server, small_spec(), sensors={3: {}})
        with pytest.raises(ValueError, match="2 names for 1 seats"):
            await server.host(small_spec(), names=["a", "b"])

    serving(tmp_path, play)


def test_an_address_in_use_is_an_error(tmp_path: Path) -> None:
    async def play(server: MatchServer, address: str) -> None:
        other = MatchServer()
        with pytest.raises(AddressInUseError, match="in use"):
            await other.start([address])
        (port,) = await other.start(["127.0.0.1:0"])
        third = MatchServer()
        with pytest.raises(AddressInUseError, match="in use"):
            await third.start([port])
        await other.stop()

    serving(tmp_path, play)


@pytest.mark.parametrize(
    "address", ["50051", "localhost:x", "unix:/no/such/folder/socket", "unix:/tmp/" + "x" * 120]
)
def test_a_malformed_address_is_a_usage_error(tmp_path: Path, address: str) -> None:
    async def play(server: MatchServer, _: str) -> None:
        other = MatchServer()
        with pytest.raises(UserError) as caught:
            await other.start([address])
        assert caught.value.exit_code == 2

    serving(tmp_path, play)


def test_the_health_service_answers(tmp_path: Path) -> None:
    async def play(server: MatchServer, address: str) -> None:
        async with grpc.aio.insecure_channel(address) as channel:
            stub = health_pb2_grpc.HealthStub(channel)
            for service in ("", "wildscav.match.v1.Match"):
                answer = await stub.Check(health_pb2.HealthCheckRequest(service=service))
                assert answer.status == health_pb2.HealthCheckResponse.SERVING

    serving(tmp_path, play)

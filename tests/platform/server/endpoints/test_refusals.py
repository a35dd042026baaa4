"""What the server refuses, and how it says so."""

import asyncio
from contextlib import AsyncExitStack
from pathlib import Path

import grpc
import pytest
from grpc_health.v1 import health_pb2, health_pb2_grpc
from tests.platform.helpers.manual_clock import ServedByHand, with_server_by_hand
from tests.platform.helpers.seats import (
    HandPlayed,
    Served,
    connected,
    ended,
    host,
    seated,
    serving,
    small_spec,
    start_agent,
    with_server,
)

from wildscav.errors import SensorError
from wildscav.proto.match_pb2 import Action, ClientMessage, Join, Ready
from wildscav.wire.errors import reason_of
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.http2.accounting import UNKNOWN_LIMIT
from wildscav_server.match_server import MatchServer
from wildscav_server.time_limits import Clock


async def refused(seat: HandPlayed) -> tuple[grpc.StatusCode, str]:
    """Read to the end of a stream; return its status and the reason in its details."""
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        await seat.read_out()
    return caught.value.code(), reason_of(caught.value)


@with_server
async def test_a_wrong_token(served: Served) -> None:
    agent = await start_agent("Walker", served.address, "no-such-token")
    code, errors = await ended(agent)
    assert code == 4
    assert "no seat here has this token (SEAT_TOKEN_UNKNOWN)" in errors


@with_server
async def test_a_seat_cannot_be_taken_twice(served: Served) -> None:
    hosted = await served.host(small_spec())
    async with connected(served.address) as first, connected(served.address) as second:
        await first.join(hosted.tokens[0])
        await second.send(join(hosted.tokens[0]))
        assert await refused(second) == (grpc.StatusCode.ALREADY_EXISTS, "SEAT_TAKEN")
        assert (await first.play_out()).match_over.conduct.status == SeatStatus.FINISHED


@with_server
async def test_a_seat_with_its_own_address_is_not_taken_over_another(served: Served, tmp_path: Path) -> None:
    first, second = await served.server.start([f"unix:{tmp_path / name}.sock" for name in "12"])
    hosted = await served.host(small_spec(seats=2), addresses={0: first, 1: second})
    for token, address in ((0, second), (1, first), (1, served.address)):
        async with connected(address) as thief:
            await thief.send(join(hosted.tokens[token]))
            assert await refused(thief) == (grpc.StatusCode.PERMISSION_DENIED, "SEAT_ELSEWHERE")
    async with connected(first) as one, connected(second) as other:
        await one.join(hosted.tokens[0])
        await other.join(hosted.tokens[1])
        await asyncio.gather(one.play_out(), other.play_out())
    assert {report.status for report in (await hosted.finished()).seats.values()} == {"finished"}
    anywhere = await served.host(small_spec())
    async with seated(second, anywhere) as (seat,):
        await seat.play_out()


@with_server
async def test_an_address_of_a_seat_must_be_one_of_the_servers(served: Served) -> None:
    with pytest.raises(ValueError, match="an address for seat 1, which no submission fills"):
        await served.host(small_spec(), addresses={1: served.address})
    with pytest.raises(ValueError, match="does not listen on unix:/elsewhere"):
        await served.host(small_spec(), addresses={0: "unix:/elsewhere"})


@with_server
async def test_another_version_of_the_protocol(served: Served) -> None:
    hosted = await served.host(small_spec())
    async with connected(served.address) as seat:
        await seat.send(join(hosted.tokens[0], version=2))
        assert await refused(seat) == (grpc.StatusCode.FAILED_PRECONDITION, "PROTOCOL_VERSION")
    async with served.seated(hosted) as (seat,):
        await seat.play_out()


def join(token: str, version: int = 1, **fields: bool) -> ClientMessage:
    return ClientMessage(join=Join(token=token, protocol_version=version, **fields))


def action(step: int) -> ClientMessage:
    return ClientMessage(action=Action(step=step))


@pytest.mark.parametrize(
    ("nonsense", "reason", "detail"),
    [
        ([b"\xff\xff\xff"], "PROTOCOL_ERROR", "not a ClientMessage"),
        ([ClientMessage()], "PROTOCOL_ERROR", "must be an Action"),
        ([join("again")], "PROTOCOL_ERROR", "must be an Action"),
        ([ClientMessage(ready=Ready())], "PROTOCOL_ERROR", "must be an Action"),
        ([action(7)], "TOO_EARLY", "before it was asked"),
        ([action(0)] * 17, "FLOOD", "old answers"),
        ([b"\0" * 5000], "MESSAGE_TOO_LARGE", "a message of 5,000 bytes; 4,096 are allowed"),
        ([b"\0" * 1_000_000], "MESSAGE_TOO_LARGE", "a message of 1,000,000 bytes; 4,096 are allowed"),
    ],
    ids=["garbage", "empty", "second join", "not asked for", "future step", "flood", "large", "huge"],
)
@with_server
async def test_a_seat_that_talks_nonsense_is_out_and_the_others_play_on(
    served: Served, nonsense: list[ClientMessage | bytes], reason: str, detail: str
) -> None:
    hosted = await served.host(small_spec(seats=2))
    async with served.seated(hosted) as (bad, good):
        await bad.read()
        for message in nonsense:
            await bad.send(message)
        await good.play_out(walk_speed=3.0)
        code = "RESOURCE_EXHAUSTED" if reason == "MESSAGE_TOO_LARGE" else "INVALID_ARGUMENT"
        assert await refused(bad) == (grpc.StatusCode[code], reason)
    outcome = await hosted.finished()
    assert outcome.seats[0].status == SeatStatus.PROTOCOL_ERROR
    assert detail in outcome.seats[0].detail
    assert (outcome.seats[1].status, outcome.seats[1].steps_played) == (SeatStatus.FINISHED, 20)
    assert outcome.seconds < 5.0


@pytest.mark.parametrize("first", [b"\xff\xff", action(0)], ids=["garbage", "action"])
@with_server
async def test_a_stream_begins_with_a_join(served: Served, first: ClientMessage | bytes) -> None:
    async with connected(served.address) as client:
        await client.send(first)
        assert await refused(client) == (grpc.StatusCode.INVALID_ARGUMENT, "PROTOCOL_ERROR")


def test_a_stream_that_says_nothing_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wildscav_server.endpoints.match_service.JOIN_TIMEOUT", 0.2)

    async def play(server: MatchServer, address: str) -> None:
        async with connected(address) as client:
            assert await refused(client) == (grpc.StatusCode.INVALID_ARGUMENT, "JOIN_TIMEOUT")

    serving(tmp_path, play)


def test_of_too_many_pending_streams_at_an_address_the_oldest_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wildscav_server.endpoints.match_service.PENDING_LIMIT", 3)

    async def play(server: MatchServer, address: str) -> None:
        (other,) = await server.start([f"unix:{tmp_path / 'other.sock'}"])
        hosted = await host(server, small_spec(seats=2))
        async with AsyncExitStack() as stack, connected(other) as elsewhere:
            await asyncio.sleep(0.05)  # so that it is older than all of the first address
            silent = []
            for _ in range(3):
                silent.append(await stack.enter_async_context(connected(address)))
                await asyncio.sleep(0.05)  # so that they come one after the other
            async with connected(address) as seat:
                await elsewhere.join(hosted.tokens[0])
                await seat.join(hosted.tokens[1])
                await asyncio.gather(elsewhere.play_out(), seat.play_out())
            assert await refused(silent[0]) == (grpc.StatusCode.RESOURCE_EXHAUSTED, "SERVER_BUSY")

    serving(tmp_path, play)


@with_server_by_hand
async def test_who_wants_to_get_ready_first_has_time_for_it_and_no_more(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(seats=2), clock=Clock(join_timeout=0.75))
    async with connected(served.address) as slow, connected(served.address) as never:
        for seat, number in ((slow, 0), (never, 1)):
            await seat.send(join(hosted.tokens[number], gets_ready=True))
            assert (await seat.read()).HasField("match_info")
        await served.pass_time(0.5)  # longer than a step's budget
        await slow.send(ClientMessage(ready=Ready()))
        while not hosted.seats[0].ready:  # noqa: ASYNC110
            await asyncio.sleep(0)
        await served.pass_time(0.25)
        assert (await slow.play_out()).match_over.conduct.status == SeatStatus.FINISHED
        assert await refused(never) == (grpc.StatusCode.FAILED_PRECONDITION, "SEAT_CLOSED")
    outcome = await hosted.finished()
    assert outcome.seats[0].time_bank == hosted.clock.time_bank
    assert (outcome.seats[1].status, outcome.seats[1].detail) == (
        SeatStatus.NEVER_JOINED,
        "did not get ready within 0.75 s",
    )


@with_server
async def test_sensors_and_names_are_checked(served: Served) -> None:
    with pytest.raises(SensorError, match="no sensor 'sonar'; the sensors are depth"):
        await served.host(small_spec(), sensors={0: {"sonar": {}}})
    with pytest.raises(SensorError, match="width"):
        await served.host(small_spec(), sensors={0: {"depth": {"width": -1}}})
    with pytest.raises(ValueError, match="seat 3"):
        await served.host(small_spec(), sensors={3: {}})
    with pytest.raises(ValueError, match="2 names for 1 seats"):
        await served.server.host(small_spec(), names=["a", "b"])


@with_server
async def test_health_checks_are_answered_however_many_bytes_they_have_in_all(served: Served) -> None:
    unknown_field = b"\x7a\xa0\x1f" + bytes(4000)  # what a thousand checks have, ten have with this
    request = health_pb2.HealthCheckRequest.FromString(unknown_field)
    named = health_pb2.HealthCheckRequest(service="wildscav.match.v1.Match")
    async with grpc.aio.insecure_channel(served.address) as channel:
        check = health_pb2_grpc.HealthStub(channel).Check
        for asked in (named, *[request] * (UNKNOWN_LIMIT // len(unknown_field) + 2)):
            assert (await check(asked)).status == health_pb2.HealthCheckResponse.SERVING


@with_server
async def test_a_seat_that_is_closed_while_its_first_message_is_under_way_hears_why(served: Served) -> None:
    hosted = await served.host(small_spec())
    async with connected(served.address) as seat:
        await seat.send(join(hosted.tokens[0]))
        while hosted.seats[0].stream is None:  # noqa: ASYNC110 - then it is about to write
            await asyncio.sleep(0)
        hosted.give_up(0, "its process ended")
        async with asyncio.timeout(5):
            assert (await refused(seat))[1] == "SEAT_CLOSED"

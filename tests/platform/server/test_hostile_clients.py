"""Clients that mean harm: they cost no other seat its time, and the server nothing for good."""

import asyncio
import contextlib
import gc
import os
import socket
import threading
from collections.abc import Sequence
from pathlib import Path

import grpc
import pytest
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as some
from tests.platform.helpers.attacked_server import Siege, memory
from tests.platform.helpers.hostile_client import ATTACKS, REASONS, Move
from tests.platform.helpers.manual_clock import HOP, ServedByHand, with_server_by_hand
from tests.platform.helpers.seats import (
    Served,
    connected,
    ended,
    host,
    serving,
    small_spec,
    start_agent,
    with_server,
)

from wildscav.proto.match_pb2 import ClientMessage, Join
from wildscav_engine.parallel.threads import cores
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_server.endpoints.endpoint import EndpointSettings
from wildscav_server.hosting.precompile import precompile
from wildscav_server.match_server import MatchServer
from wildscav_server.time_limits import Clock

ATTACKS_MADE = 600  # in all; another number by WILDSCAV_ATTACKS
AT_ONCE = 100
CAMPAIGN = 2_500  # attacks that hypothesis draws at a time: it remembers each of them, 10 kB
GROWTH = 40e6  # bytes that may come on top: what the allocator and the tests keep


def drawn(number: int, rounds: int) -> list[list[list[Move]]]:
    """Return sequences of moves that hypothesis draws, others for each number: some at once in each round."""
    found = []

    @seed(number)
    @settings(
        max_examples=rounds,
        deadline=None,
        phases=[Phase.generate],
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(some.lists(ATTACKS, min_size=AT_ONCE, max_size=AT_ONCE))
    def draw(moves: list[list[Move]]) -> None:
        found.append(moves)

    draw()
    return found


def campaign(siege: Siege, number: int, rounds: int, memories: list[int]) -> None:
    """Attack with sequences of moves, others for each number."""
    for moves in siege.meanwhile(drawn, number, rounds):
        endings = set(siege.attack(moves))
        assert endings <= REASONS | {"", "too large for gRPC"}, (endings, moves)
        gc.collect()
        memories.append(memory())


@pytest.mark.slow
def test_no_sequence_of_messages_harms_the_server_or_another_match(tmp_path: Path) -> None:
    attacks = int(os.environ.get("WILDSCAV_ATTACKS", ATTACKS_MADE))
    precompile()
    siege = Siege(tmp_path)
    memories: list[int] = []
    try:
        size = min(CAMPAIGN, attacks)
        for number in range(-(-attacks // CAMPAIGN)):
            campaign(siege, number, size // AT_ONCE, memories)
            print(f"{(number + 1) * size:,} attacks, {memories[-1] / 1e6:.0f} MB")  # noqa: T201
    finally:
        honest = siege.end()
    steps, late = sum(one.steps_played for one in honest), sum(one.late_steps for one in honest)
    p99, most = max(one.think_time.p99 for one in honest), max(one.think_time.max for one in honest)
    settled = memories[len(memories) // 2]  # gRPC and the test itself have what they keep
    print(  # noqa: T201 - the figures of a run by hand
        f"honest agents: {len(honest):,} matches, {steps:,} steps, {late} late, "
        f"p99 {p99 * 1e3:.1f} ms at worst, max {most * 1e3:.1f} ms; "
        f"memory {memories[0] / 1e6:.0f}, {settled / 1e6:.0f} half-way, {memories[-1] / 1e6:.0f} MB"
    )
    assert late == 0
    assert steps > 10
    assert memories[-1] - settled < GROWTH


def raw_connections(path: str, count: int, said: Sequence[bytes]) -> list[socket.socket]:
    """Open connections that say some bytes and no more, in turn."""
    opened = []
    for number in range(count):
        one = socket.socket(socket.AF_UNIX)
        one.connect(path)
        with contextlib.suppress(BrokenPipeError):
            one.sendall(said[number % len(said)])
        one.setblocking(False)
        opened.append(one)
    return opened


def still_open(one: socket.socket) -> bool:
    try:
        while content := one.recv(65_536):
            del content
    except BlockingIOError:
        return True
    except ConnectionError:
        return False
    return False


PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"
SETTINGS = b"\0\0\0\4\0\0\0\0\0"


@pytest.mark.slow
@pytest.mark.parametrize(
    "said",
    [
        pytest.param([PREFACE + SETTINGS], id="half-open"),
        pytest.param(
            [b"", b"GET / HTTP/1.1\r\n\r\n", PREFACE, PREFACE + SETTINGS + b"\xff" * 5000, bytes(range(256))],
            id="silent, of HTTP/1, half a handshake, garbage frames and garbage",
        ),
    ],
)
@with_server
async def test_thousands_of_connections_leave_a_match_its_time(served: Served, said: list[bytes]) -> None:
    hosted = await served.host(small_spec(seconds=6.0))
    agent = await start_agent("Walker", served.address, hosted.tokens[0])
    while hosted.match.step_number == 0:  # noqa: ASYNC110
        await asyncio.sleep(0.01)
    path = served.address.removeprefix("unix:")
    flood = await asyncio.to_thread(raw_connections, path, 3000, said)
    assert await ended(agent) == (0, "")
    report = (await hosted.finished()).seats[0]
    assert (report.status, report.late_steps) == ("finished", 0)
    async with asyncio.timeout(120):  # a busy machine takes a while to close the others
        while sum(map(still_open, flood)) > 2000:  # noqa: ASYNC110
            await asyncio.sleep(0.1)
    for one in flood:
        one.close()
    later = await served.host(small_spec())  # the flood gone, all is as before
    agent = await start_agent("Walker", served.address, later.tokens[0])
    assert await ended(agent) == (0, "")


@with_server
async def test_one_address_has_so_many_connections_and_the_others_are_free(
    served: Served, tmp_path: Path
) -> None:
    server = MatchServer(endpoint_settings=EndpointSettings(connections=4))
    address, second = await server.start([f"unix:{tmp_path / name}.sock" for name in ("first", "second")])
    flood = await asyncio.to_thread(raw_connections, second.removeprefix("unix:"), 50, [b""])
    await asyncio.sleep(0.2)
    assert sum(map(still_open, flood)) <= 4
    hosted = await host(server, small_spec())
    agent = await start_agent("Walker", address, hosted.tokens[0])
    assert await ended(agent) == (0, "")
    for one in flood:
        one.close()
    await server.stop()


@with_server_by_hand
async def test_a_reader_that_does_not_read_costs_its_seat_alone(served: ServedByHand) -> None:
    before = memory()
    depth = {"depth": {"width": 400, "height": 400}}  # 640 kB each: more than is sent ahead
    spec, limits = small_spec(seats=2, seconds=3.0), Clock(step_budget=0.05, time_bank=0.1)
    hosted = await served.host(spec, sensors={0: depth}, clock=limits)
    agent = await start_agent("Walker", served.address, hosted.tokens[1])
    async with connected(served.address) as deaf:
        await deaf.send(ClientMessage(join=Join(token=hosted.tokens[0], protocol_version=1)))
        while not hosted.task.done():
            # Time passes only while nobody waits for the other one.
            answered = hosted.seats[1].conduct.steps_played > hosted.match.step_number
            await served.pass_time(HOP if answered or hosted.match.over else 0.0)
        outcome = await hosted.finished()
    assert await ended(agent) == (0, "")
    assert (outcome.seats[0].status, outcome.seats[0].steps_played) == ("timed_out", 0)
    assert (outcome.seats[1].status, outcome.seats[1].late_steps) == ("finished", 0)
    assert memory() - before < 50e6


@with_server
async def test_a_flood_of_unknown_clients_costs_a_match_no_step(served: Served) -> None:
    refused, over = 0, False

    async def knock() -> None:
        nonlocal refused
        while not over:
            async with connected(served.address) as seat:
                await seat.send(ClientMessage(join=Join(token="mine?", protocol_version=1)))  # noqa: S106
                with pytest.raises(grpc.aio.AioRpcError):
                    await seat.read_out()
                refused += 1

    flood = [asyncio.create_task(knock()) for _ in range(60)]
    while refused <= 120:
        hosted = await served.host(small_spec(seconds=6.0))
        agent = await start_agent("Walker", served.address, hosted.tokens[0])
        assert await ended(agent) == (0, "")
        report = (await hosted.finished()).seats[0]
        assert (report.status, report.late_steps) == ("finished", 0)
    over = True
    await asyncio.gather(*flood)


def test_maps_of_calls_that_were_cancelled_keep_no_match_from_its_end(tmp_path: Path) -> None:
    begun: list[MatchSpec] = []
    go_on = threading.Event()

    def make(spec: MatchSpec) -> Match:
        begun.append(spec)
        go_on.wait()
        return Match(spec)

    async def play(server: MatchServer, _: str) -> None:
        running = await host(server, small_spec())
        calls = [asyncio.create_task(host(server, small_spec(), make=make)) for _ in range(200)]
        while not begun:  # noqa: ASYNC110
            await asyncio.sleep(0.01)
        for call in calls:
            call.cancel()
        await asyncio.wait(calls)
        running.give_up(0, "its process ended")
        try:
            async with asyncio.timeout(30):
                assert (await running.finished()).match.over
        finally:
            go_on.set()
        assert len(begun) <= cores()

    serving(tmp_path, play)

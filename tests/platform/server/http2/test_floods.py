"""Floods of frames and connections below gRPC: they cost the seat that sends them, and nobody else."""

import asyncio
import contextlib
import os
import socket
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
from tests.platform.helpers import raw_http2
from tests.platform.helpers.attacked_server import memory
from tests.platform.helpers.seats import Served, ended, host, serving, small_spec, start_agent, with_server

from wildscav.proto.match_pb2 import Action, ClientMessage
from wildscav_server.endpoints.endpoint import EndpointSettings
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.http2.accounting import READ_COST, Account, FloodError
from wildscav_server.match_server import MatchServer
from wildscav_server.time_limits import Clock

# So that only a victim that is kept from playing is late, however busy the machine is.
PATIENT = Clock(step_budget=5.0, join_timeout=60.0)
OWN = EndpointSettings(connections=16, max_total_connections=64)  # as an evaluation has it
GROWTH = 50e6  # bytes
SEQUENCES = int(os.environ.get("WILDSCAV_SEQUENCES", "300"))
EVERY_DAY = ("connect", "ping", "large-continuation")
OTHER_KINDS = [kind for kind in raw_http2.KINDS if kind not in EVERY_DAY]
# Each kind from a seat and a process of its own, some at the same time.
GROUPS = [
    *((kind,) for kind in EVERY_DAY),
    *(pytest.param(OTHER_KINDS[first::3], marks=pytest.mark.slow) for first in range(3)),
]
GROUPS_OF_UNKNOWN = [
    ("connect",),
    *(
        pytest.param(kinds, marks=pytest.mark.slow)
        for kinds in (("hold", "silent"), ("ping", "large-continuation"), ("reset", "headers"))
    ),
]


@contextmanager
def flooding(*arguments: str) -> Iterator[None]:
    """Flood a server from another process for as long as the block lasts."""
    flooder = subprocess.Popen([sys.executable, raw_http2.__file__, *arguments], stderr=subprocess.DEVNULL)
    try:
        yield
    finally:
        flooder.kill()
        flooder.wait()


def test_the_allowance_lasts_as_long_as_a_client_acknowledges_what_it_is_sent() -> None:
    asyncio.run(acknowledge_and_flood())


async def acknowledge_and_flood() -> None:
    unknown, known = (Account(send=lambda _: None, on_known=lambda: None) for _ in range(2))
    for _ in range(10_000):
        unknown.refill(100, begins=True)
        unknown.spend(READ_COST)
        for _ in range(3):  # windows of the stream and of the connection, and a ping
            unknown.spend(1.0)
    known.mark_authenticated()
    for client, frames in ((unknown, 300), (known, 900)):
        client.spend(frames)
        with pytest.raises(FloodError, match="flooded its connection"):
            client.spend(1000.0)


@pytest.mark.parametrize("kinds", GROUPS, ids=", ".join)
def test_a_seat_that_floods_its_socket_is_put_out_and_costs_another_no_step(
    tmp_path: Path, kinds: Sequence[str], caplog: pytest.LogCaptureFixture
) -> None:
    honest = len(kinds)  # the last seat

    async def play(_: MatchServer, __: str) -> None:
        server = MatchServer(endpoint_settings=OWN)
        *own, others = await server.start([f"unix:{tmp_path / name}" for name in (*kinds, "others")])
        before = memory()
        spec = small_spec(seats=honest + 1, seconds=5.0)
        addresses = dict(enumerate((*own, others)))
        hosted = await host(server, spec, addresses=addresses, clock=PATIENT, starting=True)
        with ExitStack() as floods:
            for seat, kind in enumerate(kinds):
                floods.enter_context(flooding(kind, own[seat], hosted.tokens[seat]))
            agent = await start_agent("Walker", others, hosted.tokens[honest])
            for seat in addresses:
                hosted.launched(seat)
            reports = (await hosted.finished()).seats
        assert await ended(agent) == (0, "")
        for seat, kind in enumerate(kinds):
            assert reports[seat].status == SeatStatus.PROTOCOL_ERROR, kind
            assert reports[seat].status.fault == "agent"
            assert reports[seat].detail.startswith(("flooded its ", "sent ", "did not begin ")), kind
        assert (reports[honest].status, reports[honest].late_steps) == ("finished", 0)
        assert reports[honest].steps_played == 50
        assert reports[honest].time_bank == hosted.clock.time_bank
        assert memory() - before < GROWTH
        await server.stop()

    serving(tmp_path, play)
    assert not [record for record in caplog.records if record.name == "asyncio"]


@pytest.mark.parametrize("kinds", GROUPS_OF_UNKNOWN, ids=", ".join)
@with_server
async def test_unknown_clients_that_flood_an_address_keep_nobody_from_joining_there(
    served: Served, kinds: Sequence[str]
) -> None:
    (address,) = await served.server.start(["127.0.0.1:0"])
    before = memory()
    with ExitStack() as floods:
        for kind in kinds:
            floods.enter_context(flooding(kind, address))
        hosted = await served.host(small_spec(seconds=5.0), clock=PATIENT)
        agent = await start_agent("Walker", address, hosted.tokens[0])
        seat = (await hosted.finished()).seats[0]
    assert await ended(agent) == (0, "")
    assert (seat.status, seat.late_steps, seat.steps_played) == ("finished", 0, 50)
    assert memory() - before < GROWTH


@pytest.mark.parametrize(
    ("scrap", "bearable"),
    [
        (1, False),  # each byte costs the server as much as a whole message
        (100, True),  # as a slow network may deliver it
    ],
)
@with_server
async def test_a_seat_that_sends_its_answers_byte_by_byte_is_put_out(
    served: Served, scrap: int, bearable: bool
) -> None:
    hosted = await served.host(small_spec(seconds=1.0), clock=PATIENT)
    seat = hosted.seats[0]
    with raw_http2.greet(served.address) as client:
        client.sendall(raw_http2.join(1, hosted.tokens[0]))
        client.setblocking(False)
        step = 0
        while not (hosted.match.over or seat.gone):
            await asyncio.sleep(0)
            if seat.asked == step:
                step += 1
                await send_in_scraps(client, raw_http2.message(1, long_answer(seat.asked)), scrap)
        report = (await hosted.finished()).seats[0]
    told = (report.status, report.steps_played, report.detail)
    put_out = (
        SeatStatus.PROTOCOL_ERROR,
        0,
        "flooded its connection with frames that carry no message, or in pieces",
    )
    assert told == (("finished", 10, "") if bearable else put_out)


def long_answer(step: int) -> bytes:
    """The largest answer that there may be: most of it is a field that nobody knows."""
    answer = ClientMessage(action=Action(step=step)).SerializeToString()
    padding = 4096 - len(answer) - 3
    return answer + bytes([15 << 3 | 2, padding % 128 + 128, padding // 128]) + bytes(padding)


async def send_in_scraps(client: socket.socket, content: bytes, size: int) -> None:
    """Send something so that the server, in this very loop, reads piece by piece."""
    for at in range(0, len(content), size):
        with contextlib.suppress(BrokenPipeError):
            client.send(content[at : at + size])
        await asyncio.sleep(0)
        await asyncio.sleep(0)


@pytest.mark.slow
def test_no_random_sequence_of_frames_harms_the_server_or_a_match(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    async def play(server: MatchServer, address: str) -> None:
        before = memory()
        hosted = await host(server, small_spec(seconds=600.0), clock=PATIENT)
        agent = await start_agent("Walker", address, hosted.tokens[0])
        attack = (sys.executable, raw_http2.__file__, "random", address, str(SEQUENCES), "1")
        attacker = await asyncio.create_subprocess_exec(*attack)
        assert await attacker.wait() == 0
        seat = hosted.seats[0].report()
        assert seat.status == "finished"  # so far
        assert seat.late_steps == 0
        assert memory() - before < GROWTH
        hosted.cancel()
        await ended(agent)
        again = await host(server, small_spec(), clock=PATIENT)
        agent = await start_agent("Walker", address, again.tokens[0])
        assert await ended(agent) == (0, "")

    serving(tmp_path, play, patience=300.0 + SEQUENCES)
    assert not [record for record in caplog.records if record.name == "asyncio"]

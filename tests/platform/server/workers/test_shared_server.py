"""A shared server: which worker plays a match, and what becomes of one that ends, hangs or errs."""

import asyncio
import os
import signal
import socket
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import grpc
import pytest
from tests.platform.helpers.seats import connected, ended, small_spec, start_agent

from wildscav.errors import UserError
from wildscav.proto.match_pb2 import GetMatchRequest, GetMatchResponse, HostMatchRequest, HostMatchResponse
from wildscav.proto.match_pb2_grpc import ArenaStub
from wildscav.wire.errors import RefusalError, reason_of
from wildscav.wire.matches import decode_seat_address
from wildscav_server.hosting.precompile import precompile
from wildscav_server.leftovers import own_folder
from wildscav_server.workers import supervisor
from wildscav_server.workers.dispatcher import Dispatcher
from wildscav_server.workers.shared_server import SharedServer
from wildscav_server.workers.supervisor import WorkerSupervisor
from wildscav_server.workers.worker import WorkerConfig

State = GetMatchResponse.State


def shared(listen: str, test: Callable[[SharedServer, str, ArenaStub], Awaitable[None]], **how: Any) -> None:
    """Run a test with a server of two workers, and see that it leaves no process behind."""

    async def run() -> None:
        server = SharedServer(2, **how)
        (address,) = await server.start([listen])
        try:
            async with asyncio.timeout(90), grpc.aio.insecure_channel(address) as channel:
                await test(server, address, ArenaStub(channel))
        finally:
            await server.stop()

    precompile()  # compiling is not what is tested
    asyncio.run(run())


def request(seconds: float = 2.0) -> HostMatchRequest:
    return HostMatchRequest(spec_json=small_spec(seconds=seconds).model_dump_json())


async def join(hosted: HostMatchResponse, called: str) -> asyncio.subprocess.Process:
    return await start_agent("Walker", decode_seat_address(hosted, called), hosted.seat_tokens[0])


async def state(arena: ArenaStub, match_id: str, token: Any = None) -> GetMatchResponse:
    """Return how a match stands as soon as it neither waits nor plays."""
    while True:
        answer: GetMatchResponse = await arena.GetMatch(GetMatchRequest(match_id=match_id), metadata=token)
        if answer.state not in (State.STATE_JOINING, State.STATE_PLAYING):
            return answer
        await asyncio.sleep(0.05)


async def playing(arena: ArenaStub, match_id: str) -> None:
    """Wait until a match's seats are taken."""
    while (await arena.GetMatch(GetMatchRequest(match_id=match_id))).state != State.STATE_PLAYING:  # noqa: ASYNC110
        await asyncio.sleep(0.05)


async def reason(call: Awaitable[Any]) -> str:
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        await call
    return reason_of(caught.value)


@pytest.mark.slow
def test_a_worker_that_dies_fails_its_matches_alone_and_comes_back(tmp_path: Path) -> None:
    async def play(server: SharedServer, address: str, arena: ArenaStub) -> None:
        lost, kept = [await arena.HostMatch(request(seconds=60.0)) for _ in range(2)]
        agents = [await join(one, address) for one in (lost, kept)]
        await playing(arena, lost.match_id)
        worker = server.workers[0]
        os.kill(worker._process.pid, signal.SIGKILL)  # type: ignore[union-attr]
        answer = await state(arena, lost.match_id)
        assert answer.state == State.STATE_FAILED
        assert answer.error == "the platform failed: worker 1 ended during the match"
        code, said = await ended(agents[0])
        assert (code, "went away" in said) == (4, True), said
        meanwhile = await arena.HostMatch(request(seconds=0.5))  # whose turn it is may be gone
        assert await ended(await join(meanwhile, address)) == (0, "")
        assert await ended(agents[1]) == (0, "")
        while worker.generation == 1:  # noqa: ASYNC110
            await asyncio.sleep(0.1)
        again = [await arena.HostMatch(request(seconds=0.5)) for _ in range(2)]
        assert {one.match_id.partition("-")[0] for one in again} == {"1.2", "2.1"}
        for one in again:
            assert await ended(await join(one, address)) == (0, "")
            assert (await state(arena, one.match_id)).state == State.STATE_FINISHED

    shared(f"unix:{tmp_path}/match.sock", play)


@pytest.mark.slow
def test_workers_play_in_turn_what_the_desk_does_not_refuse_and_are_joined_themselves(tmp_path: Path) -> None:
    token = (("authorization", "Bearer correct horse"),)

    async def play(server: SharedServer, address: str, arena: ArenaStub) -> None:
        assert await reason(arena.HostMatch(request())) == "ORGANIZER_TOKEN"
        wrong = HostMatchRequest(spec_json="{}")
        assert await reason(arena.HostMatch(wrong, metadata=token)) == "SPEC_INVALID"
        for unknown in ("", "x", "1.1-x", "1.7-abc", "9.1-abc", "1.-1-x"):
            ask = GetMatchRequest(match_id=unknown)
            assert await reason(arena.GetMatch(ask, metadata=token)) == "MATCH_UNKNOWN"
        hosted = [await arena.HostMatch(request(), metadata=token) for _ in range(2)]
        assert {decode_seat_address(one, address) for one in hosted} == {
            worker.seats[0] for worker in server.workers
        }
        async with connected(address) as seat:
            assert await reason(seat.join(hosted[0].seat_tokens[0])) == "SEAT_TOKEN_UNKNOWN"
        worker = server.workers[0].seats[0]
        async with grpc.aio.insecure_channel(worker) as channel:  # a worker's own address opens no match
            assert await reason(ArenaStub(channel).HostMatch(request(), metadata=token)) == ""
        agents = [await join(one, address) for one in hosted]
        assert [await ended(agent) for agent in agents] == [(0, ""), (0, "")]
        for one in hosted:
            answer = await state(arena, one.match_id, token)
            assert (answer.state, answer.steps) == (State.STATE_FINISHED, 20)
            assert answer.conduct[0].status == "finished"
            assert answer.record

    shared(f"unix:{tmp_path}/match.sock", play, organizer_token="correct horse")  # noqa: S106


@pytest.mark.slow
def test_an_address_that_a_worker_cannot_have_is_named_and_nothing_stays(tmp_path: Path) -> None:
    async def start() -> None:
        server = SharedServer(2)
        with pytest.raises(UserError, match=r"cannot listen on unix:.*match\.sock\.2: it is in use already"):
            await server.start([f"unix:{tmp_path}/match.sock"])
        processes = [worker._process for worker in server.workers]
        assert all(process is not None and process.returncode is not None for process in processes)

    with socket.socket(socket.AF_UNIX) as other:
        other.bind(f"{tmp_path}/match.sock.2")
        other.listen()
        asyncio.run(start())


@pytest.mark.parametrize("address", ["nonsense", "0.0.0.0:0", "unix:/dev/null/socket"])
def test_an_address_that_is_refused_leaves_no_folder(address: str) -> None:
    folder = own_folder()

    async def run() -> None:
        with pytest.raises(UserError):
            await SharedServer(2).start([address])
        assert list(folder.glob("serve-*")) == []

    asyncio.run(run())


READY = "input(); print('{\"seats\": []}', flush=True); input()"


class Notes:
    """A log that can be read."""

    def __init__(self) -> None:
        self.lines: list[tuple[str, dict[str, Any]]] = []

    def warning(self, event: str, **about: Any) -> None:
        self.lines.append((event, about))

    info = warning


class Interpreter:
    """Stands for the Python that workers are run by: a script that a test can exchange."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self._path, self._real = folder / "python", sys.executable
        monkeypatch.setattr(supervisor.sys, "executable", str(self._path))

    def runs(self, code: str) -> None:
        fresh = self._path.with_name("fresh")
        fresh.write_text(f"#!{self._real}\n{code}\n")
        fresh.chmod(0o755)
        fresh.replace(self._path)

    def is_gone(self) -> None:
        self._path.unlink()


def started(notes: Notes) -> WorkerSupervisor:
    return WorkerSupervisor(WorkerConfig(seats=[], arena="unix:/nowhere", number=1), notes)


@pytest.mark.parametrize(
    ("code", "why"),
    [
        ("input(); print('good morning')", "it answered 'good morning'"),
        ("input(); print(dict(tables=3))", "it answered .*tables"),
        ("input(); print('[1, 2]')", "it answered '.1, 2.'"),
        ("import sys; sys.exit(7)", "it ended with 7"),
        ("import time; time.sleep(100)", "did not start within 0.5 s"),
    ],
    ids=["no json", "nearly json", "other json", "ends", "silent"],
)
def test_a_worker_that_does_not_start_says_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, code: str, why: str
) -> None:
    Interpreter(tmp_path, monkeypatch).runs(code)
    monkeypatch.setattr(supervisor, "START_TIMEOUT", 0.5 if "within" in why else 60.0)

    async def start() -> None:
        worker = started(Notes())
        with pytest.raises(UserError, match=why):
            await worker.start()
        assert worker._process is not None
        assert worker._process.returncode is not None  # nothing is left running

    asyncio.run(start())


def test_a_worker_that_cannot_be_started_again_is_tried_until_it_can(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(supervisor, "RESTART_DELAY", 0.01)
    notes, interpreter = Notes(), Interpreter(tmp_path, monkeypatch)

    async def wait_for(event: str, text: str) -> None:
        while not any(name == event and text in str(about) for name, about in notes.lines):  # noqa: ASYNC110
            await asyncio.sleep(0.01)

    async def play() -> None:
        interpreter.runs(READY)
        worker = started(notes)
        await worker.start()
        assert worker._process is not None
        interpreter.is_gone()
        os.kill(worker._process.pid, signal.SIGKILL)
        await wait_for("worker_did_not_start", "No such file")
        interpreter.runs("input(); print('nonsense')")
        await wait_for("worker_did_not_start", "nonsense")
        interpreter.runs(READY)
        while worker.generation == 1:  # noqa: ASYNC110
            await asyncio.sleep(0.01)
        await worker.stop()

    asyncio.run(play())


def test_a_worker_that_hangs_keeps_no_call_waiting(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for limit in ("HOST_TIMEOUT", "GET_TIMEOUT"):
        monkeypatch.setattr(f"wildscav_server.workers.dispatcher.{limit}", 0.1)
    path = str(tmp_path / "arena.sock")

    async def call() -> None:
        async with grpc.aio.insecure_channel(f"unix:{path}") as channel:
            worker: Any = SimpleNamespace(number=1, generation=1, arena=ArenaStub(channel))
            dispatcher = Dispatcher([worker], 0)
            async with asyncio.timeout(10):
                with pytest.raises(RefusalError, match="no worker takes a match"):
                    await dispatcher.host_match(HostMatchRequest())
                with pytest.raises(RefusalError) as caught:
                    await dispatcher.get_match(GetMatchRequest(match_id="1.1-x"))
            assert caught.value.code == grpc.StatusCode.DEADLINE_EXCEEDED

    with socket.socket(socket.AF_UNIX) as hangs:  # connected to by the kernel, and never served
        hangs.bind(path)
        hangs.listen()
        asyncio.run(call())

"""The dispatcher's calls to its workers."""

import asyncio
import socket
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import grpc
import pytest

from wildscav.proto.match_pb2 import GetMatchRequest, HostMatchRequest
from wildscav.proto.match_pb2_grpc import ArenaStub
from wildscav.wire.errors import RefusalError
from wildscav_server.workers.dispatcher import Dispatcher


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

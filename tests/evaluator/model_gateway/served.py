"""A gateway in this process, and clients of its seats."""

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

import httpx
import pytest
from tests.scripted_model import Asked, Script, ScriptedModel

from wildscav_evaluator.model_gateway import model_server
from wildscav_evaluator.model_gateway import serve as serving
from wildscav_evaluator.model_gateway.accounts import Accounts
from wildscav_evaluator.model_gateway.settings import ModelSettings

KEY = "sk-the-organizers-own"
SEATS = (0, 1)
Body = dict[str, Any]


@dataclass
class Served:
    """A gateway that serves."""

    folder: Path
    accounts: Accounts
    requests: list[Asked]  # that reach the model's server
    reports: list[dict[str, Any]] = field(default_factory=list)

    def socket(self, seat: int = 0) -> Path:
        return self.folder / f"{seat}.sock"

    def client(self, seat: int = 0) -> httpx.AsyncClient:
        transport = httpx.AsyncHTTPTransport(uds=str(self.socket(seat)), verify=False)
        return httpx.AsyncClient(transport=transport, base_url="http://model", timeout=20.0)

    async def ask(self, *messages: str | Body, seat: int = 0, **fields: Any) -> httpx.Response:
        """Ask the model for an answer."""
        said = [one if isinstance(one, dict) else {"role": "user", "content": one} for one in messages]
        async with self.client(seat) as client:
            return await client.post("/v1/chat/completions", json={"messages": said, **fields})


Serve: TypeAlias = Callable[..., Served]


@pytest.fixture
def serve(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Serve:
    """Serve two seats as the process of a gateway does, while a function asks."""
    ready = asyncio.Event()

    def run(script: Script | str, ask: Callable[[Served], Awaitable[object]], **settings: Any) -> Served:
        def report(**facts: Any) -> None:
            gateway.reports.append(facts)
            ready.set()

        async def whole() -> None:
            end: asyncio.Future[None] = asyncio.get_running_loop().create_future()
            task = asyncio.create_task(serving.serve(setup, end))
            await ready.wait()
            try:
                await ask(gateway)
            finally:
                end.set_result(None)
                await task

        monkeypatch.setattr(serving, "report", report)
        monkeypatch.setattr(model_server, "FIRST_PAUSE", 0.01)
        with nullcontext() if isinstance(script, str) else ScriptedModel(script, KEY) as model:
            setup = serving.Setup(
                settings=ModelSettings(url=model.url if model else script, name="tiny", **settings),
                key=KEY,
                sockets={seat: tmp_path / f"{seat}.sock" for seat in SEATS},
                accounts=tmp_path / "accounts",
                exchanges=tmp_path / "exchanges.jsonl.gz",
            )
            accounts = Accounts.make(tmp_path / "accounts", SEATS)
            gateway = Served(tmp_path, accounts, model.requests if model else [])
            asyncio.run(whole())
        return gateway

    return run

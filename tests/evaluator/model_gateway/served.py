"""A gateway in this process, and clients of its seats."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import pytest
from tests.scripted_model import ScriptedModel

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


@asynccontextmanager
async def served(
    model: ScriptedModel | str, folder: Path, monkeypatch: pytest.MonkeyPatch, **settings: Any
) -> AsyncIterator[Served]:
    """Serve two seats as the process of a gateway does."""
    url = model if isinstance(model, str) else model.url
    paths = {seat: folder / f"{seat}.sock" for seat in SEATS}
    gateway = Served(folder, Accounts.make(folder / "accounts", SEATS))
    ready = asyncio.Event()

    def report(**facts: Any) -> None:
        gateway.reports.append(facts)
        ready.set()

    monkeypatch.setattr(serving, "report", report)
    monkeypatch.setattr(model_server, "FIRST_PAUSE", 0.01)
    setup = serving.Setup(
        settings=ModelSettings(url=url, name="tiny", **settings),
        key=KEY,
        sockets=paths,
        accounts=folder / "accounts",
        exchanges=folder / "exchanges.jsonl.gz",
    )
    end: asyncio.Future[None] = asyncio.get_running_loop().create_future()
    task = asyncio.create_task(serving.serve(setup, end))
    await ready.wait()
    try:
        yield gateway
    finally:
        end.set_result(None)
        await task

"""A match's gateway, as the match sees it: a process of its own, so that a flood takes none of its time."""

import asyncio
import contextlib
import json
import os
import sys
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from wildscav.errors import WildscavError
from wildscav_evaluator.model_gateway.accounts import Accounts
from wildscav_evaluator.model_gateway.settings import ModelSettings
from wildscav_server import leftovers

SOCKET = "model.sock"
START_TIME = 60.0  # s for the process to be ready, on a busy machine
END_TIME = 5.0  # s for it to end
PASSED_ON = ("PATH", "HOME", "LANG", "LC_ALL", "TMPDIR", "LD_LIBRARY_PATH", "PYTHONPATH", "SSL_CERT_FILE")


class ModelFaultError(WildscavError):
    """The gateway or the model's server failed, which is the platform's fault."""


class ModelGateway:
    """The gateway of a match.

    Attributes:
        fault: What failed, in one line; empty as long as nothing has.
    """

    def __init__(
        self, process: asyncio.subprocess.Process, accounts: Accounts, folders: Mapping[int, Path]
    ) -> None:
        self._process, self._accounts, self._folders = process, accounts, folders
        self._said = asyncio.create_task(_said_by(process))
        self.fault = ""

    def address(self, seat: int) -> str:
        """Return the address at which a seat finds the model."""
        return f"unix:{self._folders[seat] / SOCKET}"

    def written(self, seat: int) -> int:
        """Return the tokens that the model has written for a seat, with those of the last answer it got."""
        return self._accounts.written(seat)

    def is_over(self, seat: int) -> bool:
        """Return whether a seat's budget has refused a request."""
        return self._accounts.is_over(seat)

    async def watch(self, on_over: Callable[[int, str], None], on_fault: Callable[[], object]) -> None:
        """Call back when a seat's budget is spent, and when the gateway or the model's server has failed."""
        while not self.fault:
            event = await self._event()
            if "over" in event:
                on_over(event["over"], event["reason"])
            else:
                self.fault = event.get("fault") or f"the model's gateway has ended{await self._last_line()}"
                on_fault()

    async def ready(self) -> None:
        """Wait until it listens.

        Raises:
            ModelFaultError: It does not listen within some time.
        """
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(START_TIME):
                if "ready" in await self._event():
                    return
        with contextlib.suppress(ProcessLookupError):
            self._process.kill()
        raise ModelFaultError(f"the model's gateway does not start{await self._last_line()}")

    async def _last_line(self) -> str:
        """Return the last line that the process printed before its end; an empty text if it printed none."""
        line = (await self._said).strip().rpartition("\n")[2]
        return f": {line}" if line else ""

    async def _event(self) -> dict[str, Any]:
        """Return the next line of the process; an empty one if it has ended."""
        line = b"" if self._process.stdout is None else await self._process.stdout.readline()
        document: dict[str, Any] = json.loads(line or b"{}")
        return document

    async def close(self) -> None:
        """End it, when it has written its file."""
        if self._process.stdin is not None:
            self._process.stdin.close()
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(END_TIME):
                await self._process.wait()
        with contextlib.suppress(ProcessLookupError):
            self._process.kill()
        await self._process.wait()


async def _said_by(process: asyncio.subprocess.Process) -> str:
    """Return all that a process prints as its errors, when it has ended."""
    said = b"" if process.stderr is None else await process.stderr.read()
    return said.decode(errors="replace")


@asynccontextmanager
async def open_gateway(
    settings: ModelSettings | None, folders: Mapping[int, Path], exchanges: Path | None
) -> AsyncIterator[ModelGateway | None]:
    """Start the gateway of a match, and end it with the block; None without a model.

    Args:
        folders: The private folder of each seat, for its socket.
        exchanges: The file for what is asked and answered; None to write none.

    Raises:
        ModelFaultError: It does not start.
        UserError: The key of the model's server is missing.
    """
    if settings is None or not folders:
        yield None
        return
    with leftovers.temporary_folder("gateway-") as folder:
        accounts = Accounts.make(folder / "accounts", list(folders))
        setup = {
            "settings": settings.model_dump(mode="json"),
            "key": settings.key(),
            "sockets": {seat: str(path / SOCKET) for seat, path in folders.items()},
            "accounts": str(folder / "accounts"),
            "exchanges": None if exchanges is None else str(exchanges),
        }
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", f"{__package__}.serve"),
            env={name: os.environ[name] for name in PASSED_ON if name in os.environ},
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
            start_new_session=True,
        )
        gateway = ModelGateway(process, accounts, folders)
        try:
            if process.stdin is not None:
                process.stdin.write(json.dumps(setup).encode() + b"\n")
            await gateway.ready()
            yield gateway
        finally:
            await gateway.close()

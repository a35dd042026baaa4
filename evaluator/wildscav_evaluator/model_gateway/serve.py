"""The process of a gateway: ``python -m wildscav_evaluator.model_gateway.serve``.

Its first line of input says what to serve, with the key, which no file and no command line shows. It serves
until its input ends. Its lines of output say that it is ready, which seats' budgets are spent, and that the
model's server has failed.
"""

import asyncio
import json
import secrets
import socket
import sys
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import BaseModel

from wildscav.harness.answers import estimated_tokens
from wildscav_evaluator.model_gateway.accounts import Accounts
from wildscav_evaluator.model_gateway.chat import ChatError, read_request
from wildscav_evaluator.model_gateway.exchanges import Exchanges
from wildscav_evaluator.model_gateway.model_server import (
    Answered,
    ModelServer,
    RequestAtFaultError,
    ServerAtFaultError,
)
from wildscav_evaluator.model_gateway.settings import ModelSettings
from wildscav_evaluator.model_gateway.unix_http import (
    CONNECTIONS,
    INVALID,
    Request,
    Response,
    UnixServer,
    refusal,
)

CHAT, MODELS = "/v1/chat/completions", "/v1/models"
LARGEST_SETUP = 1 << 20  # bytes
OPEN_TO_ALL = 0o666  # its private folder protects a socket from others


class Setup(BaseModel):
    """What the process is to serve."""

    settings: ModelSettings
    key: str
    sockets: dict[int, Path]  # of each seat
    accounts: Path
    exchanges: Path | None


class Prompt(NamedTuple):
    """What a seat asks."""

    fields: dict[str, Any]  # that the model's server gets
    estimated: int  # tokens
    most: int | None  # tokens of the answer, if the seat says so

    @classmethod
    def read(cls, content: bytes) -> "Prompt":
        """Read it.

        Raises:
            ChatError: It is not valid.
        """
        chat = read_request(content)
        fields = chat.passed_on()
        return cls(fields, estimated_tokens(fields), chat.most)


class Desk:
    """Answers the requests of one seat."""

    def __init__(
        self,
        seat: int,
        settings: ModelSettings,
        server: ModelServer,
        accounts: Accounts,
        exchanges: Exchanges,
    ) -> None:
        self._seat, self._settings, self._server = seat, settings, server
        self._accounts, self._exchanges = accounts, exchanges
        self._salt = secrets.token_hex(16) if settings.cache_salt else ""
        self._asked = 0

    async def answer(self, request: Request) -> Response:
        """Answer a request."""
        asked = (request.method, request.target)
        if asked == ("GET", MODELS):
            return Response(200, self._models())
        if asked != ("POST", CHAT):
            return refusal(404, INVALID, f"there are POST {CHAT} and GET {MODELS}, and nothing else")
        try:
            prompt = await asyncio.to_thread(Prompt.read, request.body)
        except ChatError as error:
            return refusal(400, INVALID, str(error))
        return await self._ask(prompt)

    async def _ask(self, prompt: Prompt) -> Response:
        """Ask the model within the seat's budget."""
        fields, estimated, _ = prompt
        if spent := self._accounts.spent(self._seat, self._settings, estimated):
            if not self._accounts.is_over(self._seat):
                self._accounts.close(self._seat)
                report(over=self._seat, reason=spent)
            return refusal(429, "insufficient_quota", spent, "insufficient_quota")
        most = self._accounts.most_answer(self._seat, self._settings, *prompt[1:])
        self._accounts.begin(self._seat)
        self._asked += 1
        number, started = self._asked, time.monotonic()
        try:
            answered = await self._server.ask(fields, most, self._salt)
        except RequestAtFaultError as error:
            self._accounts.charge(self._seat, estimated, 0, time.monotonic() - started)
            await self._exchanges.write(self._seat, number, fields, {"error": str(error)})
            return refusal(error.status, INVALID, str(error), error.code)
        except ServerAtFaultError as error:
            await self._exchanges.write(self._seat, number, fields, {"fault": str(error)})
            report(fault=str(error))
            return refusal(503, "server_error", "the model's server fails: the match is played again")
        except asyncio.CancelledError:  # its client left: the model may have written all
            self._accounts.charge(self._seat, estimated, most, time.monotonic() - started)
            self._exchanges.write(self._seat, number, fields, {"error": "the agent left"})
            raise
        return await self._pass_on(answered, number, prompt, most)

    async def _pass_on(self, answered: Answered, number: int, asked: Prompt, most: int) -> Response:
        """Charge the seat for an answer, write it down, and return what is passed on of it."""
        prompt, tokens = answered.answer.tokens(asked.estimated, answered.size, most)
        self._accounts.charge(self._seat, prompt, tokens, answered.seconds)
        choice = answered.answer.choices[0].model_dump(exclude_unset=True)
        usage = {"prompt_tokens": prompt, "completion_tokens": tokens, "total_tokens": prompt + tokens}
        seconds = round(answered.seconds, 3)
        result = {"most": most, "answer": choice, "usage": usage, "seconds": seconds}
        await self._exchanges.write(self._seat, number, asked.fields, result)
        choice["message"]["role"] = "assistant"
        return Response(
            200,
            {
                "id": f"chatcmpl-{number}",
                "object": "chat.completion",
                "created": 0,
                "model": self._settings.name,
                "choices": [{"index": 0, "finish_reason": "stop", **choice}],
                "usage": usage,
            },
        )

    def _models(self) -> dict[str, Any]:
        model = {"id": self._settings.name, "object": "model", "created": 0, "owned_by": "organizer"}
        return {"object": "list", "data": [model]}


def report(**facts: Any) -> None:
    """Tell the process that started this one."""
    sys.stdout.write(json.dumps(facts) + "\n")
    sys.stdout.flush()


def _listen(path: Path) -> socket.socket:
    """Return a unix socket that listens at a path."""
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    listener.bind(str(path))
    path.chmod(OPEN_TO_ALL)
    listener.listen(CONNECTIONS)
    listener.setblocking(False)
    return listener


async def serve(setup: Setup, until: "asyncio.Future[Any]") -> None:
    """Serve all seats until a future is done."""
    settings, accounts = setup.settings, Accounts(setup.accounts, list(setup.sockets))
    with ExitStack() as stack:
        exchanges = stack.enter_context(Exchanges(setup.exchanges))
        server = stack.enter_context(ModelServer(settings, setup.key, len(setup.sockets)))
        tasks = []
        for seat, path in setup.sockets.items():
            listener = stack.enter_context(_listen(path))
            desk = Desk(seat, settings, server, accounts, exchanges)
            tasks.append(asyncio.create_task(UnixServer(listener, desk.answer).run()))
        report(ready=True)
        await asyncio.wait([until, *tasks], return_when=asyncio.FIRST_COMPLETED)
        if not until.done():
            report(fault="the model's gateway has failed")
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def main() -> None:
    """Serve what the first line of input says until the input ends."""
    loop, reader = asyncio.get_running_loop(), asyncio.StreamReader(limit=LARGEST_SETUP)
    await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), sys.stdin)
    setup = Setup.model_validate_json(await reader.readline())
    await serve(setup, asyncio.create_task(reader.read()))


if __name__ == "__main__":
    asyncio.run(main())

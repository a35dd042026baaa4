"""Asking the organizer's model, and finding out who is to blame if it does not answer.

A request that fails is tried again. An overloaded server is waited for, and no seat is blamed for it. If a
request fails in another way to the end, the gateway asks a short question of its own: if
the server answers that, the request was at fault, and so was its seat; if not, the platform is.
"""

import asyncio
import json
import time
from concurrent.futures import ThreadPoolExecutor
from http.client import HTTPException
from typing import Any, NamedTuple

from pydantic_core import to_json

from wildscav.harness.answers import BUSY, LONGEST_REASON
from wildscav.harness.connection import ModelConnection, Response
from wildscav_evaluator.model_gateway.chat import ChatAnswer, ChatError, read_answer
from wildscav_evaluator.model_gateway.settings import ModelSettings

FIRST_PAUSE, LONGEST_PAUSE = 0.5, 30.0  # s before a request is tried again
OVERLOADED = (429, 503)  # answers that no request has earned
REFUSED = (400, 413, 422)  # answers that a request may have earned
QUESTION = {"messages": [{"role": "user", "content": "Answer with the word yes."}]}
SHORT = 16  # tokens of the answer to it


class Answered(NamedTuple):
    """The model's answer."""

    answer: ChatAnswer
    size: int  # bytes of the request
    seconds: float  # s that the server took for it, without tries that it failed


class RequestAtFaultError(Exception):
    """The server works, but not for this request. The message is one line, which the seat may read."""

    def __init__(self, status: int, message: str, code: str | None = None) -> None:
        super().__init__(message)
        self.status, self.code = status, code


class ServerAtFaultError(Exception):
    """The server does not work. The message is one line."""


class _FailedError(Exception):
    """One try failed."""

    def __init__(self, message: str, status: int = 0, code: str | None = None, pause: float = 0.0) -> None:
        super().__init__(message)
        self.status, self.code, self.pause = status, code, pause


class ModelServer:
    """The organizer's model, as a context manager. It keeps nothing of one seat for another.

    Each of its ``seats`` asks one request at a time.
    """

    def __init__(self, settings: ModelSettings, key: str, seats: int) -> None:
        self._settings, self._key = settings, key
        self._works = False  # whether it has answered a request
        self._threads = ThreadPoolExecutor(2 * seats)  # those whose time is up take a moment to end
        self._idle: list[ModelConnection] = []
        self._busy: set[ModelConnection] = set()

    def __enter__(self) -> "ModelServer":
        return self

    def __exit__(self, *_: object) -> None:
        for connection in self._busy:
            connection.cut()
        self._threads.shutdown(wait=False, cancel_futures=True)
        for connection in self._idle:
            connection.close()

    async def ask(self, fields: dict[str, Any], most: int, salt: str = "") -> Answered:
        """Ask the model.

        Args:
            fields: Of the request, without those that the gateway sets.
            most: The tokens that the answer may have.
            salt: Of the seat's own cache of prompts; empty for the server's.

        Raises:
            RequestAtFaultError: The server answers other requests, but not this one.
            ServerAtFaultError: The server does not work, or not with the organizer's settings.
        """
        body, pause = await asyncio.to_thread(self._body, fields, most, salt), FIRST_PAUSE
        end, tries_left = time.monotonic() + self._settings.timeout, self._settings.retries
        while True:
            started = time.monotonic()
            try:
                answer = await self._post(body)
            except _FailedError as error:
                failed = error
            else:
                self._works = True
                return Answered(answer, len(body), time.monotonic() - started)
            wait = min(LONGEST_PAUSE, max(pause, failed.pause))
            if failed.status in OVERLOADED:
                goes_on = time.monotonic() + wait < end
            else:
                goes_on = tries_left > 0 and (failed.status in (0, *BUSY) or failed.status >= 500)
                tries_left -= 1
            if not goes_on:
                raise await self._blame(failed)
            await asyncio.sleep(wait)
            pause *= 2.0

    async def _blame(self, failed: _FailedError) -> Exception:
        """Return whose fault it is that a request failed."""
        if failed.status in OVERLOADED:
            return ServerAtFaultError(f"the model's server at {self._settings.host} is overloaded: {failed}")
        if not (failed.status in REFUSED and self._works):
            try:
                await self._post(self._body(QUESTION, SHORT, ""))
            except _FailedError as error:
                return ServerAtFaultError(f"the model's server at {self._settings.host} fails: {error}")
            self._works = True
        status = failed.status if failed.status in REFUSED else 502
        return RequestAtFaultError(status, f"the model's server failed this request: {failed}", failed.code)

    def _body(self, fields: dict[str, Any], most: int, salt: str) -> bytes:
        """Return a request with the fields that only the gateway sets."""
        own = {"model": self._settings.name, self._settings.max_tokens_field: most}
        salted = {"cache_salt": salt} if salt else {}
        return to_json({**fields, **self._settings.extra, **salted, **own})

    async def _post(self, body: bytes) -> ChatAnswer:
        """Try a request once.

        Raises:
            _FailedError: There is no answer of the model.
        """
        try:
            async with asyncio.timeout(self._settings.timeout):
                status, content, after = await self._send(body)
        except TimeoutError:
            raise _FailedError(f"it does not answer within {self._settings.timeout:g} s") from None
        except (OSError, HTTPException, ValueError) as error:
            reason = getattr(error, "strerror", "") or (str(error) if isinstance(error, OSError) else "")
            hint = "; is it running?" if isinstance(error, ConnectionRefusedError) else ""
            raise _FailedError(f"{reason or type(error).__name__}{hint}") from None
        if status == 200:
            try:
                return await asyncio.to_thread(read_answer, content)
            except ChatError as error:
                raise _FailedError(str(error)) from None
        reason, code = self._reason(content)
        pause = float(after) if after.isdecimal() else 0.0
        raise _FailedError(f"status {status}{reason}", status, code, pause)

    async def _send(self, body: bytes) -> Response:
        """Post a request by a connection of its own, for which a thread waits."""
        is_used = bool(self._idle)
        connection = self._idle.pop() if is_used else ModelConnection(self._settings.url, self._key)
        self._busy.add(connection)
        try:
            arguments = "/chat/completions", body, self._settings.timeout
            run = asyncio.get_running_loop().run_in_executor
            try:
                answered = await run(self._threads, connection.ask, *arguments)
            except ConnectionError:
                if not is_used:
                    raise
                # Servers end connections that have been idle, even as a request is sent.
                answered = await run(self._threads, connection.ask, *arguments)
        except BaseException:
            connection.cut()
            raise
        finally:
            self._busy.discard(connection)
        self._idle.append(connection)
        return answered

    def _reason(self, content: bytes) -> tuple[str, str | None]:
        """Return what the server says of a refusal, without the key, and its code."""
        try:
            error = json.loads(content)["error"]
            message, code = str(error["message"]), error.get("code")
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            return "", None
        if self._key:
            message = message.replace(self._key, "…")
        return f": {' '.join(message.split())[:LONGEST_REASON]}", code if isinstance(code, str) else None

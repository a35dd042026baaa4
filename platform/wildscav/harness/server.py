"""Asks a model: again if its server fails, as long as there is time, and counts what that takes.

At a gateway, a request is waited for and made once, because the gateway has its own limit and tries again.
"""

import json
import time
from collections.abc import Mapping, Sequence
from http.client import HTTPException
from typing import Any

from wildscav.errors import UserError
from wildscav.harness.answers import Answer, ModelError, read_answer, refusal
from wildscav.harness.connection import SOCKET, ModelConnection
from wildscav.harness.log import Log
from wildscav.harness.settings import ModelSettings
from wildscav.harness.spending import Spending

LONGEST_PAUSE = 30.0  # s between two tries
LONGEST_WISH = 120.0  # s, likewise, if the server asks for them


class ModelServer:
    """The server of a model, for one match, which writes down what requests take.

    Raises:
        UserError: The address is not valid.
    """

    def __init__(self, settings: ModelSettings, spending: Spending, log: Log) -> None:
        self._settings, self._spending, self._log = settings, spending, log
        try:
            self._connection = ModelConnection(settings.url, settings.key)
        except (ValueError, HTTPException) as error:
            raise UserError(f"the model's url {settings.url!r} is not valid: {error}", 2) from None
        is_gateway = settings.url.startswith(SOCKET)
        self._retries, self._timeout = (
            (0, float("inf")) if is_gateway else (settings.retries, settings.timeout)
        )
        self._model = settings.name

    def ask(self, messages: Sequence[Any], tools: Sequence[Any]) -> Answer:
        """Return the model's answer.

        Raises:
            ModelError: It gave none, however often it was asked.
        """
        attempt = 0
        while True:  # until there is an answer, or _fail raises
            began = time.monotonic()
            try:
                document = self._post(messages, tools)
                answer = read_answer(document, [messages, tools], self._spending.requests)
                self._log.answered(document, time.monotonic() - began)
            except (ModelError, RecursionError) as error:
                failed = error if isinstance(error, ModelError) else ModelError("its answer is too deep")
                self._fail(failed, attempt, time.monotonic() - began)
            else:
                self._spending.add(answer.prompt_tokens, answer.answer_tokens, time.monotonic() - began)
                return answer
            attempt += 1

    def close(self) -> None:
        """Close its connections."""
        self._connection.close()

    def _fail(self, error: ModelError, attempt: int, seconds: float) -> None:
        """Wait for the next try.

        Raises:
            ModelError: There is none.
        """
        self._log.failed(str(error), error.status, seconds)
        self._spending.failures += 1
        self._spending.seconds += seconds
        pause = max(min(error.after, LONGEST_WISH), min(LONGEST_PAUSE, self._settings.pause * 2**attempt))
        if not error.may_pass or attempt >= self._retries:
            raise error
        if pause >= self._left():
            self._spending.seconds += self._left()
            raise error
        time.sleep(pause)
        self._spending.seconds += pause

    def _left(self) -> float:
        """Return how many seconds the model may still be waited for."""
        budget = self._settings.seconds
        return float("inf") if budget is None else max(0.0, budget - self._spending.seconds)

    def _post(self, messages: Sequence[Any], tools: Sequence[Any]) -> object:
        """Ask once, and return the JSON that the server answers."""
        self._model = self._model or _first_of(self._document("/models", None))
        others = {"model": self._model, "tools": tools, **self._settings.request}
        self._log.asked(messages, others)
        return self._document("/chat/completions", {"messages": messages, **others})

    def _document(self, path: str, body: Mapping[str, Any] | None) -> object:
        """Return the JSON that the server answers to a request."""
        seconds = min(self._timeout, max(0.01, self._left()))
        content = None if body is None else json.dumps(body).encode("ascii")
        try:
            response = self._connection.ask(path, content, seconds)
        except TimeoutError:
            raise ModelError(f"its server gave no answer within {seconds:g} s") from None
        except (OSError, HTTPException, ValueError) as error:
            raise ModelError(f"its server cannot be reached: {error}") from None
        try:
            document: object = json.loads(response.content)
        except (ValueError, RecursionError):
            document = None
        if response.status >= 300:
            raise refusal(response.status, document, response.retry_after)
        if document is None:
            raise ModelError("the server's answer is not JSON")
        return document


def _first_of(document: Any) -> str:
    """Return the first model in a server's list."""
    try:
        return str(document["data"][0]["id"])
    except (TypeError, KeyError, IndexError):
        raise ModelError("its server lists no model: name one", may_pass=False) from None

"""Asks a model: again if its server fails, as long as there is time, and counts what that takes.

At a gateway, a request is waited for and made once, because the gateway has its own limit and tries again.
"""

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from wildscav.errors import UserError
from wildscav.harness.answers import Answer, ModelError, read_answer
from wildscav.harness.gateway_client import GatewayClient
from wildscav.harness.log import Log
from wildscav.harness.settings import SOCKET, ModelSettings
from wildscav.harness.spending import Spending

if TYPE_CHECKING:
    from wildscav.harness.openai_client import OpenAIClient

LONGEST_PAUSE = 30.0  # s between two tries
LONGEST_WISH = 120.0  # s, likewise, if the server asks for them


class ModelServer:
    """The server of a model, for one match.

    Args:
        settings: Where it is, and how it is asked.
        spending: Gets what requests take.
        log: Gets requests and answers.

    Raises:
        UserError: The address is not valid, or the client for it is not installed.
    """

    def __init__(self, settings: ModelSettings, spending: Spending, log: Log) -> None:
        self._settings, self._spending, self._log = settings, spending, log
        self._client = _client_of(settings)
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
        for attempt in range(self._retries + 1):
            began = time.monotonic()
            try:
                document = self._post(messages, tools)
                answer = read_answer(document, [messages, tools], self._spending.requests)
                self._log.answered(document, time.monotonic() - began)
            except ModelError as error:
                self._fail(error, attempt, time.monotonic() - began)
            except RecursionError:
                self._fail(ModelError("the server's answer is too deep"), attempt, time.monotonic() - began)
            else:
                seconds = time.monotonic() - began
                self._spending.add(answer.prompt_tokens, answer.answer_tokens, seconds)
                return answer
        raise ModelError("it was not asked")  # not reached: the last failure is raised

    def close(self) -> None:
        """Close its connections."""
        self._client.close()

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
        seconds = min(self._timeout, max(0.01, self._left()))
        self._model = self._model or _first_of(self._client.ask("/models", None, seconds))
        others = {"model": self._model, "tools": tools, **self._settings.request}
        self._log.asked(messages, others)
        return self._client.ask("/chat/completions", {"messages": messages, **others}, seconds)


def _first_of(document: Any) -> str:
    """Return the first model in a server's list."""
    try:
        return str(document["data"][0]["id"])
    except (TypeError, KeyError, IndexError):
        raise ModelError("its server lists no model: name one", may_pass=False) from None


def _client_of(settings: ModelSettings) -> "GatewayClient | OpenAIClient":
    """Return the client for an address. That of OpenAI takes a second to load, which gateways do not need."""
    if settings.url.startswith(SOCKET):
        return GatewayClient(settings.url.removeprefix(SOCKET))
    try:
        from wildscav.harness.openai_client import OpenAIClient
    except ModuleNotFoundError as error:
        raise UserError(f"{error.name} is missing: pip install 'wildscav[language]'", 2) from None
    return OpenAIClient(settings.url, settings.key)

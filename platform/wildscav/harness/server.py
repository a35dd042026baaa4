"""Asks a model by the official client of OpenAI's protocol. Import it late: the client takes a second."""

import json
import time
from collections.abc import Iterator, Sequence
from typing import Any

import httpx2
import openai

from wildscav.errors import UserError
from wildscav.harness.answers import QUOTA, Answer, ModelError, read_answer
from wildscav.harness.log import Log
from wildscav.harness.settings import SOCKET, ModelSettings
from wildscav.harness.spending import Spending

LARGEST_ANSWER = 8 << 20  # bytes
LONGEST_PAUSE = 30.0  # s between two tries
LONGEST_WISH = 120.0  # s, likewise, if the server asks for them
LONGEST_REASON = 300  # characters of a server's words that are kept
BUSY = (408, 409, 425, 429)  # answers, besides those from 500 on, after which a request is tried again
CONNECT_TIME = 10.0  # s
ANY_KEY = "none"  # since the client wants one


class ModelServer:
    """The server of a model, for one match.

    Args:
        settings: Where it is, and how it is asked.
        spending: Gets what requests take.
        log: Gets requests and answers.
    """

    def __init__(self, settings: ModelSettings, spending: Spending, log: Log) -> None:
        self._settings, self._spending, self._log = settings, spending, log
        is_socket = settings.url.startswith(SOCKET)
        transport = BoundedTransport(uds=settings.url.removeprefix(SOCKET) if is_socket else None)
        try:
            self._client = openai.OpenAI(
                base_url="http://model/v1" if is_socket else settings.url,
                api_key=settings.key or ANY_KEY,
                max_retries=0,  # ours are counted, logged, and end with the budget
                http_client=httpx2.Client(transport=transport, headers={"Accept-Encoding": "identity"}),
            )
        except (ValueError, httpx2.InvalidURL) as error:
            raise UserError(f"the model's url {settings.url!r} is not valid: {error}", 2) from None
        self._model = settings.name

    def ask(self, messages: Sequence[Any], tools: Sequence[Any]) -> Answer:
        """Return the model's answer; try again if its server fails, as long as there is time.

        Raises:
            ModelError: It gave none.
        """
        for attempt in range(self._settings.retries + 1):
            began = time.monotonic()
            try:
                document = self._post(messages, tools)
                answer = read_answer(document, [messages, tools], self._spending.requests)
            except ModelError as error:
                self._fail(error, attempt, time.monotonic() - began)
                continue
            seconds = time.monotonic() - began
            self._log.answered(document, seconds)
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
        if not error.may_pass or attempt >= self._settings.retries:
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
        self._model = self._model or self._first_model()
        others = {"model": self._model, "tools": tools, **self._settings.request}
        self._log.asked(messages, others)
        return self._document(self._client.post, "/chat/completions", body={"messages": messages, **others})

    def _first_model(self) -> str:
        """Return the first model that the server lists."""
        document = self._document(self._client.get, "/models")
        try:
            return str(document["data"][0]["id"])  # type: ignore[index]
        except (TypeError, KeyError, IndexError):
            raise ModelError("its server lists no model: name one", may_pass=False) from None

    def _document(self, send: Any, path: str, **content: Any) -> object:
        """Return the JSON that the server answers to a request."""
        seconds = min(self._settings.timeout, max(0.01, self._left()))
        timeout = httpx2.Timeout(seconds, connect=min(CONNECT_TIME, seconds))
        try:
            response = send(path, cast_to=httpx2.Response, options={"timeout": timeout}, **content)
            document: object = json.loads(response.content)
        except openai.APIStatusError as error:
            raise _refusal(error) from None
        except openai.APITimeoutError:
            raise ModelError(f"its server gave no answer within {seconds:g} s") from None
        except openai.APIConnectionError as error:
            raise ModelError(f"its server cannot be reached: {error.__cause__ or error}") from None
        except (ValueError, RecursionError):
            raise ModelError("the server's answer is not JSON") from None
        return document


def _refusal(error: Any) -> ModelError:
    """Return the error of an answer with a status of failure."""
    status, body = error.status_code, error.body if isinstance(error.body, dict) else {}
    code = str(body.get("code") or body.get("type") or "")
    said = str(body.get("message") or error.message)[:LONGEST_REASON]
    may_pass = (status in BUSY or status >= 500) and code != QUOTA
    try:
        after = max(0.0, float(error.response.headers.get("retry-after", 0.0)))
    except ValueError:  # a date
        after = 0.0
    message = " ".join(f"its server answers {status}: {said}".split())
    return ModelError(message, status, code, may_pass=may_pass, after=after)


class BoundedTransport(httpx2.HTTPTransport):
    """Connections on which answers end: after 8 MiB, or when the time for a read is over for all of them."""

    def handle_request(self, request: httpx2.Request) -> httpx2.Response:
        """Send a request, and return the answer, whose body is not read yet."""
        end = time.monotonic() + request.extensions["timeout"]["read"]
        response = super().handle_request(request)
        if response.headers.get("content-encoding", "identity") != "identity":
            raise httpx2.RemoteProtocolError("the answer is compressed, though none was asked to be")
        response.stream = _Bounded(response.stream, end)
        return response


class _Bounded(httpx2.SyncByteStream):
    """A body that ends."""

    def __init__(self, stream: Any, end: float) -> None:
        self._stream, self._end = stream, end

    def __iter__(self) -> Iterator[bytes]:
        size = 0
        for piece in self._stream:
            size += len(piece)
            if size > LARGEST_ANSWER:
                raise httpx2.RemoteProtocolError(f"the answer has more than {LARGEST_ANSWER:,} bytes")
            if time.monotonic() > self._end:
                raise httpx2.ReadTimeout("the answer does not end")
            yield piece

    def close(self) -> None:
        self._stream.close()

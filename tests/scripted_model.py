"""A server of OpenAI's chat protocol whose model is a script, with all the ways in which servers misbehave.

It is a real HTTP server, for tests of whatever talks to models:

    with ScriptedModel(in_turn(called("go", place="target"), said("I am there."))) as model:
        ...  # talk to model.url, and see model.requests
"""

import json
import socket
import socketserver
import struct
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from itertools import count
from pathlib import Path
from typing import Any, NamedTuple, Self, TypeAlias

CHARACTERS_PER_TOKEN = 4
TOKENS_PER_PICTURE = 300
COUNTED = "counted"  # the usage of an answer that counts right
PIECE = 16_384  # bytes that an endless answer sends at a time
LONGEST = 30.0  # s after which even an endless answer ends


class Call(NamedTuple):
    """A call of a tool. Its arguments are a text, since a model may write anything."""

    name: str
    arguments: str


@dataclass(frozen=True)
class Said:
    """An answer as it should be, at least by its form."""

    text: str | None = None
    calls: tuple[Call, ...] = ()
    usage: object = COUNTED  # as the answer has it; None: it has none


@dataclass(frozen=True)
class Failed:
    """An error of the server."""

    status: int
    message: str = "the server failed"
    headers: Mapping[str, str] = field(default_factory=dict)  # such as Retry-After


@dataclass(frozen=True)
class Late:
    """An answer that comes after some seconds, unless the server is closed meanwhile."""

    seconds: float
    answer: "Answer" = field(default_factory=Said)


@dataclass(frozen=True)
class Reset:
    """The connection is reset in place of an answer."""


@dataclass(frozen=True)
class Endless:
    """An answer that never ends: a flood, or a drip if there is a pause (s) between its pieces."""

    pause: float = 0.0


@dataclass(frozen=True)
class Raw:
    """An answer of any bytes."""

    body: bytes
    status: int = 200


Answer: TypeAlias = Said | Failed | Late | Reset | Endless | Raw
Messages: TypeAlias = list[dict[str, Any]]
Script: TypeAlias = Callable[[Messages, list[dict[str, Any]]], Answer]  # of the messages and the tools

NO_CHOICES = Raw(b'{"id": "0", "object": "chat.completion", "choices": []}')


def said(text: str, **arguments: Any) -> Said:
    """Return an answer in prose."""
    return Said(text, **arguments)


def called(name: str, /, **arguments: Any) -> Said:
    """Return an answer that calls a tool."""
    return Said(calls=(Call(name, json.dumps(arguments)),))


def cut(name: str, arguments: str = '{"place": "tar') -> Said:
    """Return half a call of a tool."""
    return Said(calls=(Call(name, arguments),))


def too_many(seconds: float | None = None) -> Failed:
    """Return the refusal of a request too many, which may say when to try again."""
    headers = {} if seconds is None else {"Retry-After": f"{seconds:g}"}
    return Failed(429, "too many requests", headers)


def in_turn(*answers: Answer) -> Script:
    """Return a script that gives one answer after another, and the last one again and again."""
    left = iter(answers)
    last = [answers[-1]]

    def answer(_: Messages, __: list[dict[str, Any]]) -> Answer:
        return next(left, last[0])

    return answer


def disturbed(script: Script, disturbances: Mapping[int, Answer]) -> Script:
    """Return a script with other answers to some requests, by their numbers from 0."""
    numbers = count()

    def answer(messages: Messages, tools: list[dict[str, Any]]) -> Answer:
        return disturbances.get(next(numbers)) or script(messages, tools)

    return answer


class Asked(NamedTuple):
    """A request that the server got."""

    path: str
    headers: Mapping[str, str]
    body: dict[str, Any]
    at: float  # s, of time.monotonic


class ScriptedModel:
    """Serves a script while its context lasts.

    Args:
        script: Returns the answer to each request; it may be called from several threads.
        key: What a request must carry; by default, all are answered.
        path: Of a unix socket to listen on, instead of a port of this machine.
    """

    name = "scripted"

    def __init__(self, script: Script, key: str | None = None, path: Path | None = None) -> None:
        self.script, self.key, self.path = script, key, path
        self.requests: list[Asked] = []
        self.closing = threading.Event()
        self._server = _Server(("127.0.0.1", 0), _Handler) if path is None else _SocketServer(path, _Handler)
        self._server.model = self
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.02,), daemon=True)

    @property
    def url(self) -> str:
        """The base URL of the protocol; or the address of the unix socket."""
        if self.path is not None:
            return f"unix:{self.path}"
        return f"http://127.0.0.1:{self._server.server_address[1]}/v1"

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.closing.set()
        self._server.shutdown()
        self._server.server_close()


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    block_on_close = False
    request_queue_size = 64
    model: ScriptedModel

    def handle_error(self, request: object, client_address: object) -> None:
        """Say nothing of clients that left."""


class _SocketServer(_Server):
    address_family = socket.AF_UNIX

    def __init__(self, path: Path, handler: type[BaseHTTPRequestHandler]) -> None:
        super().__init__(str(path), handler)  # type: ignore[arg-type]

    def server_bind(self) -> None:
        """Bind to a path, which has no port."""
        socketserver.TCPServer.server_bind(self)


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    wbufsize = -1  # so that an answer is one packet, not two that wait for each other
    server: _Server

    def do_GET(self) -> None:
        if self.path != "/v1/models":
            return self._send_error(404, f"there is no {self.path}")
        models = [{"id": ScriptedModel.name, "object": "model", "owned_by": "tests"}]
        return self._send(200, json.dumps({"object": "list", "data": models}).encode())

    def do_POST(self) -> None:
        model = self.server.model
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        try:
            request = json.loads(body)
            messages = request["messages"]
        except (ValueError, KeyError, TypeError):
            return self._send_error(400, "a request has messages")
        model.requests.append(Asked(self.path, dict(self.headers), request, time.monotonic()))
        if self.path != "/v1/chat/completions":
            return self._send_error(404, f"there is no {self.path}")
        if model.key is not None and self.headers.get("Authorization") != f"Bearer {model.key}":
            return self._send_error(401, "the key is wrong")
        return self._answer(model.script(messages, request.get("tools") or []), request)

    def log_message(self, *_: object) -> None:
        """Keep quiet."""

    def _answer(self, answer: Answer, request: dict[str, Any]) -> None:
        match answer:
            case Said():
                self._send(200, json.dumps(_completion(answer, request)).encode())
            case Failed(status, message, headers):
                self._send_error(status, message, headers)
            case Raw(body, status):
                self._send(status, body)
            case Late(seconds, later):
                if not self.server.model.closing.wait(seconds):
                    self._answer(later, request)
            case Reset():
                self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                self.connection.close()
                self.close_connection = True
            case Endless(pause):
                self._send_endlessly(pause)

    def _send_endlessly(self, pause: float) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "application/json")
        self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(b'{"choices": [{"index": 0, "message": {"role": "assistant", "content": "')
        end = time.monotonic() + LONGEST
        while time.monotonic() < end and not self.server.model.closing.wait(pause):
            self.wfile.write(b"and " * (1 if pause else PIECE // 4))
        self.close_connection = True

    def _send_error(self, status: int, message: str, headers: Mapping[str, str] | None = None) -> None:
        error = {"message": message, "type": "scripted", "code": None, "param": None}
        self._send(status, json.dumps({"error": error}).encode(), headers or {})

    def _send(self, status: int, body: bytes, headers: Mapping[str, str] | None = None) -> None:
        self.send_response(status)
        for name, value in {"Content-Type": "application/json", **(headers or {})}.items():
            self.send_header(name, value)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)


def _completion(answer: Said, request: dict[str, Any]) -> dict[str, Any]:
    """Return an answer in the form of the protocol."""
    message: dict[str, Any] = {"role": "assistant", "content": answer.text}
    if answer.calls:
        message["tool_calls"] = [
            {"id": f"call_{number}", "type": "function", "function": call._asdict()}
            for number, call in enumerate(answer.calls)
        ]
    completion: dict[str, Any] = {
        "id": "chatcmpl-0",
        "object": "chat.completion",
        "created": 0,
        "model": request.get("model", ScriptedModel.name),
        "choices": [
            {"index": 0, "message": message, "finish_reason": "tool_calls" if answer.calls else "stop"}
        ],
    }
    usage = counted(request, message) if answer.usage == COUNTED else answer.usage
    return completion if usage is None else completion | {"usage": usage}


def counted(request: Mapping[str, Any], message: Mapping[str, Any]) -> dict[str, int]:
    """Return the tokens of a request and its answer: a quarter of their characters, and 300 a picture."""
    pictures, characters = 0, len(json.dumps(request.get("tools") or []))
    for one in request["messages"]:
        content = one.get("content")
        for part in content if isinstance(content, list) else [{"text": content or ""}]:
            pictures += part.get("type") == "image_url"
            characters += len(part.get("text", ""))
        characters += len(json.dumps(one.get("tool_calls", "")))
    prompt = characters // CHARACTERS_PER_TOKEN + pictures * TOKENS_PER_PICTURE
    completion = len(json.dumps(message)) // CHARACTERS_PER_TOKEN
    return {
        "prompt_tokens": prompt,
        "completion_tokens": completion,
        "total_tokens": prompt + completion,
    }

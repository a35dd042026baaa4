"""What a seat may send: anything. It reaches the model's server as a plain question, or not at all."""

import asyncio
import base64
import contextlib
import json
import threading
from io import BytesIO
from typing import Any

import pytest
from PIL import Image
from tests.evaluator.model_gateway.served import KEY, Serve, Served
from tests.scripted_model import Late, in_turn, said

from wildscav_evaluator.model_gateway import unix_http
from wildscav_evaluator.model_gateway.chat import ChatError, read_request
from wildscav_evaluator.model_gateway.model_server import ModelServer
from wildscav_evaluator.model_gateway.serve import Prompt
from wildscav_evaluator.model_gateway.settings import ModelSettings

YES = in_turn(said("yes"))
BODY = json.dumps({"messages": [{"role": "user", "content": "Where?"}]}).encode()
HEAD = b"POST /v1/chat/completions HTTP/1.1\r\nHost: model\r\n"


async def send(gateway: Served, sent: bytes, seconds: float = 20.0, *, ends: bool = True) -> bytes:
    """Send some bytes, and return all that is answered until the connection ends or some time is over, s."""
    reader, writer = await asyncio.open_unix_connection(str(gateway.socket()))
    writer.write(sent)
    if ends:
        writer.write_eof()
    answered = b""
    with contextlib.suppress(TimeoutError, ConnectionError):
        async with asyncio.timeout(seconds):
            while chunk := await reader.read(65_536):
                answered += chunk
    writer.close()
    return answered


def sized(body: bytes) -> bytes:
    return HEAD + b"Content-Length: %d\r\n\r\n" % len(body) + body


SMUGGLED = b"GET /v1/models HTTP/1.1\r\nHost: evil\r\n\r\n"
GARBAGE = HEAD + b"Transfer-Encoding: chunked\r\n\r\nno chunk\r\n"
CHUNKED = b"%x\r\n%s\r\n0\r\n\r\n" % (len(BODY), BODY)


@pytest.mark.parametrize(
    ("sent", "status"),
    [
        (sized(BODY), 200),
        (HEAD + b"Transfer-Encoding: chunked\r\n\r\n" + CHUNKED, 200),
        # Two lengths, of which another server might believe the other one.
        (HEAD + b"Content-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n" + CHUNKED, 400),
        (HEAD + b"Content-Length: 4\r\nContent-Length: 90\r\n\r\n" + BODY, 400),
        (HEAD + b"Transfer-Encoding: chunked, identity\r\n\r\n" + CHUNKED, 501),
        (HEAD + b"Transfer-Encoding : chunked\r\n\r\n" + CHUNKED, 400),
        (HEAD + b"X: a\nTransfer-Encoding: chunked\r\n\r\n" + CHUNKED, 200),
        # Other places.
        (b"GET /v1/models HTTP/1.1\r\nHost: model\r\n\r\n", 200),
        (b"GET http://127.0.0.1:1/v1/models HTTP/1.1\r\nHost: model\r\n\r\n", 404),
        (b"GET /metrics HTTP/1.1\r\nHost: model\r\n\r\n", 404),
        (b"POST /v1/chat/completions/../../admin HTTP/1.1\r\nHost: m\r\nContent-Length: 0\r\n\r\n", 404),
        (b"POST /v1/chat/completions?key=1 HTTP/1.1\r\nHost: m\r\nContent-Length: 0\r\n\r\n", 404),
        (b"CONNECT 127.0.0.1:80 HTTP/1.1\r\nHost: model\r\n\r\n", 404),
        (b"POST /v1/embeddings HTTP/1.1\r\nHost: model\r\nContent-Length: 0\r\n\r\n", 404),
        # Not HTTP, or too much of it.
        (b"\x00\x01\x02\x03\r\n\r\n", 400),
        (HEAD + b"X: " + b"a" * (200 << 10) + b"\r\n\r\n", 431),
        (HEAD + b"Content-Length: 999999999\r\n\r\n", 413),
        (HEAD + b"Content-Length: -1\r\n\r\n", 400),
        (GARBAGE, 400),
        (sized(b"["), 400),
        (sized(b"[" * 100_000), 400),
    ],
)
def test_bytes_are_one_question_or_refused(serve: Serve, sent: bytes, status: int) -> None:
    async def attack(gateway: Served) -> None:
        answered = await send(gateway, sent)
        assert answered.startswith(b"HTTP/1.1 %d" % status)
        assert answered.count(b"HTTP/1.1 ") == 1
        assert KEY.encode() not in answered

    assert all(one.path == "/v1/chat/completions" for one in serve(YES, attack).requests)


def test_what_follows_a_request_is_another_request_of_the_same_seat(serve: Serve) -> None:
    async def attack(gateway: Served) -> None:
        assert (await send(gateway, sized(BODY) + SMUGGLED)).count(b"HTTP/1.1 200") == 2

    assert len(serve(YES, attack).requests) == 1


def test_no_header_of_a_seat_reaches_the_model(serve: Serve) -> None:
    evil = b"Authorization: Bearer evil\r\nX-Forwarded-For: 1.2.3.4\r\nCookie: a=b\r\n"
    sent = sized(BODY).replace(b"Content-Length", evil + b"Content-Length")

    (asked,) = serve(YES, lambda gateway: send(gateway, sent)).requests

    headers = {name.lower(): value for name, value in asked.headers.items()}
    assert headers["authorization"] == f"Bearer {KEY}"
    assert headers.keys() <= {
        *("host", "accept", "accept-encoding", "connection", "user-agent"),
        *("content-type", "authorization", "content-length"),
    }


def test_a_slow_body_and_idle_connections_take_time_from_their_own_seat_alone(
    serve: Serve, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(unix_http, "BODY_TIME", 0.3)

    async def attack(gateway: Served) -> None:
        idle = [await asyncio.open_unix_connection(str(gateway.socket())) for _ in range(10)]
        slow = asyncio.create_task(send(gateway, sized(BODY)[:-5], ends=False))
        assert (await gateway.ask("Where?", seat=1)).status_code == 200
        assert (await slow).startswith(b"HTTP/1.1 408")
        for _, writer in idle:
            writer.close()

    serve(YES, attack)


def test_too_many_connections_wait(serve: Serve) -> None:
    async def attack(gateway: Served) -> None:
        path = str(gateway.socket())
        many = [await asyncio.open_unix_connection(path) for _ in range(unix_http.CONNECTIONS)]
        assert await send(gateway, sized(BODY), 0.2) == b""
        assert (await gateway.ask("Where?", seat=1)).status_code == 200
        for _, writer in many:
            writer.close()
        assert (await send(gateway, sized(BODY))).startswith(b"HTTP/1.1 200")

    serve(YES, attack)


def test_a_request_is_cancelled_when_its_client_leaves(serve: Serve) -> None:
    async def attack(gateway: Served) -> None:
        await send(gateway, sized(BODY), 0.5)  # closes the connection after that
        assert (await gateway.ask("And now?")).status_code == 200
        assert gateway.accounts.written(0) >= 50  # for the answer that nobody got

    serve(in_turn(Late(30.0), said("yes")), attack, max_tokens=50)


@pytest.mark.parametrize("heavy", [(Prompt, "read"), (ModelServer, "_body")], ids=str)
def test_what_is_heavy_for_one_seat_stops_no_other(
    serve: Serve, monkeypatch: pytest.MonkeyPatch, heavy: tuple[type, str]
) -> None:
    light, others_are_served = getattr(*heavy), threading.Event()

    def work(*arguments: Any) -> Any:
        assert "heavy" not in str(arguments) or others_are_served.wait(20.0)
        return light(*arguments)

    monkeypatch.setattr(*heavy, work)

    async def attack(gateway: Served) -> None:
        slow = asyncio.create_task(gateway.ask("heavy"))
        await asyncio.sleep(0.1)
        assert (await gateway.ask("Where?", seat=1)).status_code == 200
        others_are_served.set()
        assert (await slow).status_code == 200

    serve(YES, attack)


@pytest.mark.parametrize("sent", [b"GET /nothing HTTP/1.1\r\nHost: model\r\n\r\n", GARBAGE])
def test_a_flood_of_refusals_is_slowed_down(serve: Serve, sent: bytes) -> None:
    async def attack(gateway: Served) -> None:
        loop = asyncio.get_running_loop()
        before = loop.time()
        await asyncio.gather(*(send(gateway, sent) for _ in range(6)))
        assert loop.time() - before >= 6 * unix_http.REFUSAL_PAUSE  # one after another

    serve(YES, attack)


HELLO = {"messages": [{"role": "user", "content": "Hello"}]}
GO = {"type": "function", "function": {"name": "go"}}


def picture(size: tuple[int, int] = (2, 2), kind: str = "PNG") -> str:
    content = BytesIO()
    Image.new("1" if kind == "PNG" else "L", size).save(content, kind)
    return base64.b64encode(content.getvalue()).decode()


def with_picture(url: str) -> dict[str, Any]:
    return {"messages": [{"role": "user", "content": [{"type": "image_url", "image_url": {"url": url}}]}]}


def with_schema(schema: dict[str, Any]) -> dict[str, Any]:
    function = {"name": "go", "parameters": {"type": "object", "properties": {"a": schema}}}
    return HELLO | {"tools": [{"type": "function", "function": function}]}


@pytest.mark.parametrize(
    "body",
    [
        with_picture(f"data:image/png;base64,{picture()}"),
        with_picture(f"data:image/jpeg;base64,{picture(kind='JPEG')}"),
        with_schema({"$ref": "#/$defs/place"}),
        {"messages": [{"role": "assistant", "content": None, "tool_calls": []}]},
        HELLO | {"tool_choice": GO},
    ],
)
def test_what_is_in_the_request_itself_is_passed_on(body: dict[str, Any]) -> None:
    assert read_request(json.dumps(body).encode()).passed_on() == body


def test_a_tool_is_chosen_by_its_name_alone() -> None:
    longer = {"type": "function", "function": {"name": "go", "description": "spy", "strict": True}}

    assert read_request(json.dumps(HELLO | {"tool_choice": longer}).encode()).passed_on()["tool_choice"] == GO


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        (with_picture("http://127.0.0.1/secret.png"), "in the request itself"),
        (with_picture("file:///etc/passwd"), "in the request itself"),
        (with_picture("data:image/svg+xml;base64,PHN2Zz4="), "in the request itself"),
        (with_picture("data:image/png;base64,AAAA"), "neither a PNG nor a JPEG"),
        (with_picture(f"data:image/png;base64,{picture((5000, 2))}"), "5,000 pixels"),
        (with_schema({"$ref": "http://127.0.0.1/schema.json"}), "leads out of the schema"),
        (with_schema({"anyOf": [{"$ref": "other.json"}]}), "leads out of the schema"),
        ({"messages": []}, "messages"),
        ({"messages": [{"role": "user", "content": [{"type": "file", "file": {"file_id": "1"}}]}]}, "type"),
        ({"messages": [{"role": "root", "content": "Hello"}]}, "role"),
        ({"messages": [{"role": "user", "content": "Hello"}], "stream": True}, "one piece"),
        ({"messages": [{"role": "user", "content": "Hello"}], "temperature": 1e99}, "temperature"),
        ({"messages": [{"role": "user", "content": "Hello"}], "max_tokens": 0}, "max_tokens"),
        (with_schema({"enum": ["a" * 70_000]}), "a schema may have 65,536 bytes"),
        (with_schema({"enum": [[]] * 100_000}), "100,000 commas and opening brackets"),
    ],
)
def test_what_somebody_would_have_to_fetch_is_refused(body: dict[str, Any], reason: str) -> None:
    with pytest.raises(ChatError, match=reason):
        read_request(json.dumps(body).encode())


@pytest.mark.parametrize(
    ("settings", "reason"),
    [
        ({"url": "ftp://host"}, "url"),
        ({"url": "http://host:99999/v1"}, "port"),
        ({"url": "http://host:ab/v1"}, "port"),
        ({"url": "http:///v1"}, "no host"),
        ({"url": "http://user:secret@host/v1"}, "url"),
        ({"key_env": "A", "key_file": "b"}, "one of them"),
        ({"extra": {"model": "other"}}, "the gateway sets that itself"),
        ({"money": 1.0}, "are 0"),
        ({"tokens": 0}, "tokens"),
    ],
)
def test_settings_that_cannot_be_meant_are_refused(settings: dict[str, Any], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        ModelSettings.model_validate({"url": "http://host/v1", "name": "tiny"} | settings)

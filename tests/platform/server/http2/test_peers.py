"""HTTP/2 as peers speak it that nobody here wrote: gRPC in C and JavaScript, h2, nghttp, h2load and curl."""

import json
import re
import shutil
import socket
import subprocess
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path

import grpc
import pytest
from tests.platform.helpers.raw_http2 import REQUEST
from tests.platform.server.http2.peers import CHECK, ECHO, HANG, LARGE, REFUSE, SIZE, Server

from wildscav.wire.errors import reason_of

HERE = Path(__file__).parent
JAVASCRIPT = HERE.parents[3] / "submissions" / "homing-js"
SOME = b"what is echoed"
CLOSING_TIME = 5.0  # s


def run(*command: str | Path, folder: Path | None = None) -> str:
    """Run a program; skipped where there is none."""
    if shutil.which(command[0]) is None:
        pytest.skip(f"there is no {command[0]}")
    done = subprocess.run(command, cwd=folder, capture_output=True, timeout=120, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout.decode(errors="replace")


# gRPC's own client, in C.


@pytest.fixture
def channel(server: Server) -> Iterator[grpc.Channel]:
    options = [("grpc.use_local_subchannel_pool", 1), ("grpc.max_receive_message_length", -1)]
    channel = grpc.insecure_channel(server.address, options)
    yield channel
    # It may wait for ever for calls that were cancelled: gRPC's core loses the end of one now and then.
    closing = threading.Thread(target=channel.close, daemon=True)
    closing.start()
    closing.join(CLOSING_TIME)


@pytest.mark.parametrize(
    ("method", "content", "options", "code"),
    [
        (CHECK, b"", {}, grpc.StatusCode.OK),
        (ECHO, SOME, {"timeout": 20}, grpc.StatusCode.OK),
        (ECHO, bytes(1 << 20), {}, grpc.StatusCode.OK),
        (
            ECHO,
            SOME,
            {"metadata": [(f"name-{number}", "y" * 500) for number in range(15)]},
            grpc.StatusCode.OK,
        ),
        (ECHO, SOME, {"metadata": [("name-bin", bytes(range(256)))]}, grpc.StatusCode.OK),
        (ECHO, bytes((1 << 20) + 1), {}, grpc.StatusCode.RESOURCE_EXHAUSTED),
        (ECHO, bytes(999), {"compression": grpc.Compression.Gzip}, grpc.StatusCode.INVALID_ARGUMENT),
        (HANG, b"", {"timeout": 0.1}, grpc.StatusCode.DEADLINE_EXCEEDED),
        (REFUSE, b"", {}, grpc.StatusCode.NOT_FOUND),
        ("/no/method", b"", {}, grpc.StatusCode.UNIMPLEMENTED),
    ],
)
def test_calls_of_grpc(
    channel: grpc.Channel, method: str, content: bytes, options: dict[str, object], code: grpc.StatusCode
) -> None:
    call = channel.stream_stream(method)(iter([content]), **options)
    got, error = [], None
    try:
        got += call
    except grpc.RpcError as caught:
        error = caught

    assert call.code() == code
    assert got == ([] if error else [content if method == ECHO else b"\x08\x01"])
    if method == REFUSE:
        assert (call.details(), reason_of(error)) == ("nothing to see: 100 % of it, naïve", "SOME_REASON")


def test_more_calls_of_grpc_than_a_connection_may_have(channel: grpc.Channel) -> None:
    large = channel.unary_unary(LARGE)
    calls = [large.future(SOME) for _ in range(300)]
    for call in calls[::3]:
        call.cancel()

    assert {len(call.result()) for call in calls if not call.cancelled()} == {SIZE}


# gRPC's client in JavaScript.


@pytest.mark.slow
def test_calls_of_grpc_js(server: Server, tmp_path: Path) -> None:
    for name in ("package.json", "package-lock.json"):
        shutil.copy(JAVASCRIPT / name, tmp_path)
    shutil.copy(HERE / "grpc_js_client.mjs", tmp_path)
    try:
        run("npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", folder=tmp_path)
    except AssertionError as error:
        pytest.skip(f"npm cannot install the packages: {error}")

    results = run("node", "grpc_js_client.mjs", server.address, ECHO, HANG, LARGE, CHECK, folder=tmp_path)

    assert json.loads(results) == {
        "check": 2,
        "large": SIZE,
        "deadline": 4,
        "nothing": 12,
        "stream": [0, 0, 1, 200_000],
        "cancelled": [1, 3],
        "many": 0,
    }


# h2, which checks every frame of the server against the state of its stream.


def echo_by_h2(
    server: Server, content: bytes, window: int, padding: int | None
) -> tuple[bytes, dict[str, str]]:
    """Echo a message; return what came back, and the trailers."""
    connection = pytest.importorskip("h2.connection")
    h2 = connection.H2Connection(pytest.importorskip("h2.config").H2Configuration(header_encoding="utf-8"))
    settings = pytest.importorskip("h2.settings").SettingCodes
    h2.initiate_connection()
    h2.update_settings({settings.INITIAL_WINDOW_SIZE: window})
    h2.send_headers(1, REQUEST)
    rest, got, trailers = b"\0" + len(content).to_bytes(4, "big") + content, b"", {}
    with socket.create_connection(server.address.split(":")) as talk:
        while not trailers:
            size = min(len(rest), h2.local_flow_control_window(1) - 1 - (padding or 0), 10_000)
            if size > 0:
                h2.send_data(1, rest[:size], pad_length=padding)
                rest = rest[size:]
                if not rest:
                    h2.send_headers(1, [("x-checksum", "7")], end_stream=True)
            talk.sendall(h2.data_to_send())
            if size > 0:
                continue
            received = talk.recv(65_536)
            assert received, "the server has closed the connection"
            for event in h2.receive_data(received):
                if type(event).__name__ == "DataReceived":
                    got += event.data
                    h2.acknowledge_received_data(event.flow_controlled_length, 1)
                elif type(event).__name__ == "TrailersReceived":
                    trailers = dict(event.headers)
            talk.sendall(h2.data_to_send())
    return got[5:], trailers


@pytest.mark.parametrize(
    ("size", "window", "padding"),
    [(0, 65_535, None), (1000, 65_535, 255), (1000, 8, None), (200_000, 65_535, 0), (200_000, 4096, 100)],
)
def test_an_echo_by_h2(server: Server, size: int, window: int, padding: int | None) -> None:
    content = bytes(number % 251 for number in range(size))

    got, trailers = echo_by_h2(server, content, window, padding)

    assert got == content
    assert trailers == {"grpc-status": "0", "grpc-message": ""}


# Programs that know nothing of gRPC, but can send the bytes of a message.


@pytest.fixture
def said(tmp_path: Path) -> Path:
    """A file with a message as gRPC frames it."""
    file = tmp_path / "message"
    file.write_bytes(b"\0" + len(SOME).to_bytes(4, "big") + SOME)
    return file


HEADERS = ("-H", "content-type: application/grpc", "-H", "te: trailers")


@pytest.mark.parametrize(
    "options",
    [
        (),
        ("--padding=200",),
        ("--window-bits=1", "--connection-window-bits=14"),
        ("--trailer=x-checksum: 7",),
        ("--no-dep", "--multiply=100"),
    ],
)
def test_nghttp(server: Server, said: Path, options: Sequence[str]) -> None:
    method = ("-H", ":method: POST")
    printed = run("nghttp", "-nv", *method, *HEADERS, "-d", said, *options, f"http://{server.address}{ECHO}")

    calls = 100 if "--multiply=100" in options else 1
    assert len(re.findall(r"recv .*grpc-status: 0", printed)) == calls, printed


def test_curl(server: Server, said: Path) -> None:
    given = ("--http2-prior-knowledge", "-sS", "--data-binary", f"@{said}", "-D", "-")

    printed = run("curl", *given, *HEADERS, f"http://{server.address}{ECHO}")

    assert printed.startswith("HTTP/2 200")
    assert SOME.decode() in printed
    assert "grpc-status: 0" in printed


def test_h2load(server: Server, said: Path) -> None:
    given = ("-n", "2000", "-c", "1", "-m", "100", "-d", said)

    printed = run("h2load", *given, *HEADERS, f"http://{server.address}{ECHO}")

    assert "2000 succeeded, 0 failed, 0 errored, 0 timeout" in printed, printed

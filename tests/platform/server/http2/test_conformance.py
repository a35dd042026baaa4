"""HTTP/2 frame by frame, as RFC 9113 and gRPC's protocol have it."""

import struct

import pytest
from tests.platform.helpers.raw_http2 import (
    CONTINUATION,
    DATA,
    GOAWAY,
    HEADERS,
    PING,
    PRIORITY,
    PUSH,
    REQUEST,
    RST,
    SETTINGS,
    WINDOW,
    frame,
    header_block,
    message,
    request,
)
from tests.platform.server.http2.peers import (
    ECHO,
    HANG,
    LARGE,
    MARK,
    Server,
    answers,
    converse,
    greeted,
)

# Codes of errors.
PROTOCOL, FLOW_CONTROL, CLOSED, SIZE_WRONG, REFUSED, COMPRESSION = 1, 3, 5, 6, 7, 9


def setting(name: int, value: int) -> bytes:
    return frame(SETTINGS, 0, 0, struct.pack(">HI", name, value))


def call(stream: int, path: str = ECHO, *more: tuple[str, str], flags: int = 4) -> bytes:
    """The headers of a call."""
    headers = [(name, path if name == ":path" else value) for name, value in REQUEST]
    return frame(HEADERS, flags, stream, header_block([*headers, *more]))


def number(value: int) -> bytes:
    return struct.pack(">I", value)


def without(name: str) -> bytes:
    return frame(HEADERS, 4, 1, header_block([header for header in REQUEST if header[0] != name]))


BLOCK = header_block(REQUEST)


@pytest.mark.parametrize(
    ("frames", "code"),
    [
        # What belongs to a stream, and what to the connection.
        (setting(1, 0)[:5] + number(1) + bytes(6), PROTOCOL),
        (request(1) + frame(SETTINGS, 0, 1), PROTOCOL),
        (request(1) + frame(PING, 0, 1, bytes(8)), PROTOCOL),
        (frame(GOAWAY, 0, 1, bytes(8)), PROTOCOL),
        (frame(DATA, 0, 0), PROTOCOL),
        (frame(HEADERS, 4, 0, BLOCK), PROTOCOL),
        (frame(RST, 0, 0, number(8)), PROTOCOL),
        # Streams that were not opened, or not by a client.
        (frame(DATA, 0, 1), PROTOCOL),
        (frame(RST, 0, 1, number(8)), PROTOCOL),
        (frame(WINDOW, 0, 1, number(1)), PROTOCOL),
        (request(2), PROTOCOL),
        (frame(PUSH, 4, 1, number(2) + BLOCK), PROTOCOL),
        # Streams that the client has ended, open or closed.
        (call(1, HANG) + frame(DATA, 1, 1) + frame(DATA, 0, 1), CLOSED),
        (call(1, HANG) + frame(DATA, 1, 1) + frame(HEADERS, 5, 1, b""), CLOSED),
        (call(1, "/nothing", flags=5) + frame(DATA, 0, 1), CLOSED),
        (call(1, "/nothing", flags=5) + frame(HEADERS, 5, 1, b""), CLOSED),
        (request(1) + frame(RST, 0, 1, number(8)) + frame(DATA, 0, 1), CLOSED),
        (request(1) + request(1), PROTOCOL),  # trailers that end nothing
        # Headers in pieces.
        (frame(HEADERS, 0, 1, BLOCK) + frame(PING, 0, 0, bytes(8)), PROTOCOL),
        (frame(HEADERS, 0, 1, BLOCK) + frame(CONTINUATION, 4, 3), PROTOCOL),
        (frame(CONTINUATION, 4, 1), PROTOCOL),
        (request(1) + frame(CONTINUATION, 4, 1), PROTOCOL),
        (frame(HEADERS, 4, 1, b"\xff\xff\xff\xff\xff\xff"), COMPRESSION),
        # Padding and lengths.
        (request(1) + frame(DATA, 8, 1, b"\x05" + bytes(4)), PROTOCOL),
        (request(1) + frame(DATA, 8, 1), SIZE_WRONG),
        (frame(HEADERS, 12, 1, b"\xff" + BLOCK), PROTOCOL),
        (frame(HEADERS, 36, 1, bytes(4)), SIZE_WRONG),
        (frame(PING, 0, 0, bytes(7)), SIZE_WRONG),
        (request(1) + frame(RST, 0, 1, bytes(3)), SIZE_WRONG),
        (request(1) + frame(PRIORITY, 0, 1, bytes(4)), SIZE_WRONG),
        (frame(SETTINGS, 0, 0, bytes(5)), SIZE_WRONG),
        (frame(SETTINGS, 1, 0, bytes(6)), SIZE_WRONG),
        (frame(WINDOW, 0, 0, bytes(3)), SIZE_WRONG),
        (request(1) + frame(DATA, 0, 1, bytes(16_385))[:9], SIZE_WRONG),
        # Windows and other settings.
        (frame(WINDOW, 0, 0, number(0)), PROTOCOL),
        (frame(WINDOW, 0, 0, number(2**31 - 1)), FLOW_CONTROL),
        (request(1) + frame(WINDOW, 0, 1, number(2**31 - 1)), FLOW_CONTROL),
        (request(1) + frame(WINDOW, 0, 1, number(2**31 - 65_536)) + setting(4, 65_536), FLOW_CONTROL),
        (setting(4, 2**31), FLOW_CONTROL),
        (call(1, HANG) + frame(DATA, 0, 1, bytes(3) + bytes([16, 0]) + bytes(9000)) * 4, FLOW_CONTROL),
        (setting(2, 2), PROTOCOL),
        (setting(5, 16_383), PROTOCOL),
        (setting(5, 2**24), PROTOCOL),
    ],
)
def test_what_http2_forbids_ends_the_connection(server: Server, frames: bytes, code: int) -> None:
    *_, last = converse(server.address, frames)

    assert last.kind == GOAWAY, "the connection stays open"
    assert int.from_bytes(last.payload[4:8], "big") == code, last.payload[8:]


@pytest.mark.parametrize(
    ("frames", "code"),
    [
        (without(":method"), PROTOCOL),
        (without(":scheme"), PROTOCOL),
        (without(":path"), PROTOCOL),
        (call(1, ECHO, ("te", "gzip")), PROTOCOL),
        (call(1, ECHO, ("te", "trailers, gzip")), PROTOCOL),
        (call(1, ECHO, ("connection", "close")), PROTOCOL),
        (call(1, ECHO, ("transfer-encoding", "chunked")), PROTOCOL),
        (call(1, ECHO, ("Upper", "case")), PROTOCOL),
        (b"".join(call(stream, HANG) for stream in range(3, 259, 2)) + call(301, HANG), REFUSED),
    ],
)
def test_a_call_that_cannot_be_is_reset_and_the_connection_goes_on(
    server: Server, frames: bytes, code: int
) -> None:
    *before, last = converse(server.address, frames)

    assert last.payload == MARK
    assert [int.from_bytes(one.payload, "big") for one in before if one.kind == RST] == [code]


def in_bytes(kind: int, content: bytes) -> bytes:
    """Content of stream 1 in frames of one byte."""
    return b"".join(frame(kind, 0, 1, content[at : at + 1]) for at in range(len(content)))


SOME = b"what is echoed"
PADDED = frame(DATA, 8, 1, b"\x09" + message(1, SOME)[9:] + bytes(9))


@pytest.mark.parametrize(
    "frames",
    [
        request(1) + message(1, SOME),
        request(1) + PADDED,
        frame(HEADERS, 12, 1, b"\xc8" + BLOCK + bytes(200)) + message(1, SOME),
        frame(HEADERS, 36, 1, bytes(5) + BLOCK) + message(1, SOME),
        frame(PRIORITY, 0, 5, bytes(5)) + request(1) + message(1, SOME),
        frame(HEADERS, 0, 1) + in_bytes(CONTINUATION, BLOCK) + frame(CONTINUATION, 4, 1) + message(1, SOME),
        request(1) + in_bytes(DATA, message(1, SOME)[9:]),
        request(1) + message(1, SOME) + frame(HEADERS, 5, 1, header_block([("x-checksum", "7")])),
        request(1) + frame(200, 255, 1, b"unknown") + frame(GOAWAY, 0, 0, bytes(8)) + message(1, SOME),
        setting(99, 2**32 - 1) + setting(1, 0) + setting(6, 100) + request(1) + message(1, SOME),
        without("te") + message(1, SOME),
        call(1, ECHO, ("grpc-timeout", "99999999H")) + message(1, SOME),
        # Frames on streams that the server has ended, which the client may not know yet.
        call(3, "/nothing") + message(3, SOME) + frame(WINDOW, 0, 3, number(9)) + frame(HEADERS, 5, 3, b"")
        + frame(RST, 0, 3, number(8)) + request(5) + message(5, SOME),
        # Streams that are skipped, and a window that is closed, opened and filled byte by byte.
        setting(4, 0) + request(77) + message(77, SOME) + setting(4, 1)
        + frame(WINDOW, 0, 77, number(1)) * len(SOME) + setting(4, 5),
    ],
)  # fmt: skip
def test_what_http2_allows_is_echoed(server: Server, frames: bytes) -> None:
    with greeted(server.address) as talk:
        talk.sendall(frames)
        data = b""
        for answer in answers(talk):
            assert answer.kind != GOAWAY, answer.payload
            data += answer.payload if answer.kind == DATA else b""
            if len(data) == 5 + len(SOME):
                break
        assert data[5:] == SOME


@pytest.mark.parametrize(
    ("timeout", "status"),
    [
        *(("1n", 4), ("50000u", 4), ("50m", 4), ("0S", 4), ("0M", 4), ("00000000H", 4)),
        *(("", 13), ("5", 13), ("m", 13), ("-1m", 13), ("123456789m", 13), ("1.5S", 13), ("5s", 13)),
    ],
)
def test_a_deadline_of_the_client_ends_its_call(server: Server, timeout: str, status: int) -> None:
    with greeted(server.address) as talk:
        talk.sendall(call(1, HANG, ("grpc-timeout", timeout)))
        trailers = next(one.payload for one in answers(talk) if one.kind == HEADERS and one.flags & 1)

    assert header_block([("grpc-status", str(status))])[1:] in trailers


def test_calls_that_are_reset_while_they_are_served_leave_nothing(server: Server) -> None:
    with greeted(server.address) as talk:
        talk.sendall(frame(WINDOW, 0, 0, number(2**30)))  # none waits for what others did not send
        for stream in range(1, 401, 2):
            path = (ECHO, HANG, LARGE)[stream % 3]
            talk.sendall(call(stream, path) + message(stream, bytes(1000)) + frame(RST, 0, stream, number(8)))
        talk.sendall(request(1001) + message(1001, SOME) + frame(DATA, 1, 1001))
        # What they received is the connection's again: else its window would be full three times over.
        assert any(one.stream == 1001 and one.flags & 1 for one in answers(talk))
    server.wait_for_calls_to_end()


def test_a_call_that_runs_survives_goaway_and_new_ones_are_refused(server: Server) -> None:
    with greeted(server.address) as talk:
        talk.sendall(request(1) + message(1, SOME))
        frames = answers(talk)
        assert any(one.kind == DATA for one in frames)
        server.call(lambda: [one.session.announce_end() for one in server.listener._open])
        goaway = next(one for one in frames if one.kind == GOAWAY)
        assert goaway.payload == number(1) + number(0)

        talk.sendall(request(3) + message(3, SOME) + message(1, SOME) + frame(DATA, 1, 1))
        rest = []
        while not rest or rest[-1].stream != 1 or not rest[-1].flags & 1:
            rest.append(next(frames))
        assert [(one.stream, one.payload) for one in rest if one.kind == RST] == [(3, number(REFUSED))]
        assert any(one.kind == DATA and one.stream == 1 for one in rest)

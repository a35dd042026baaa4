"""The frames of HTTP/2 (RFC 9113, sections 4 and 6): constants, writing and reading."""

from collections.abc import Iterator
from enum import IntEnum
from typing import NamedTuple

from hpack import Encoder, NeverIndexedHeaderTuple

PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"
HEADER = 9  # bytes of a frame before its payload
MAX_PAYLOAD = 16_384  # bytes of a payload, in both directions; every peer accepts that much
FIRST_WINDOW = 65_535  # bytes: the initial window of connections and streams, in both directions
LARGEST_WINDOW = 2**31 - 1


class Kind(IntEnum):
    """The kinds of frames."""

    DATA = 0
    HEADERS = 1
    PRIORITY = 2
    RST_STREAM = 3
    SETTINGS = 4
    PUSH_PROMISE = 5
    PING = 6
    GOAWAY = 7
    WINDOW_UPDATE = 8
    CONTINUATION = 9


class Flag(IntEnum):
    """The flags of frames, as plain numbers; the meaning of some depends on the kind."""

    END_STREAM = 0x1
    ACK = 0x1
    END_HEADERS = 0x4
    PADDED = 0x8
    PRIORITY = 0x20


PADDED_OR_PRIORITY = Flag.PADDED | Flag.PRIORITY


class Code(IntEnum):
    """Why a stream or a connection is ended."""

    NO_ERROR = 0
    PROTOCOL_ERROR = 1
    INTERNAL_ERROR = 2
    FLOW_CONTROL_ERROR = 3
    STREAM_CLOSED = 5
    FRAME_SIZE_ERROR = 6
    REFUSED_STREAM = 7
    CANCEL = 8
    COMPRESSION_ERROR = 9
    ENHANCE_YOUR_CALM = 11


class Setting(IntEnum):
    """The parameters of SETTINGS that matter here."""

    ENABLE_PUSH = 2
    MAX_CONCURRENT_STREAMS = 3
    INITIAL_WINDOW_SIZE = 4
    MAX_FRAME_SIZE = 5
    MAX_HEADER_LIST_SIZE = 6


class FrameError(Exception):
    """A peer has violated HTTP/2; the message begins with a verb: "sent …"."""

    def __init__(self, code: Code, message: str) -> None:
        super().__init__(message)
        self.code = code


class Frame(NamedTuple):
    """One frame."""

    kind: int
    flags: int
    stream: int  # 0: of the connection
    payload: bytes


def kind_name(kind: int) -> str:
    """Return the name of a kind of frame, which may be unknown."""
    return Kind(kind).name if kind <= Kind.CONTINUATION else f"kind {kind}"


def write_frame(kind: int, flags: int, stream: int, payload: bytes = b"") -> bytes:
    """Return a frame as bytes."""
    return len(payload).to_bytes(3, "big") + bytes((kind, flags)) + stream.to_bytes(4, "big") + payload


def write_settings(values: dict[Setting, int]) -> bytes:
    """Return a SETTINGS frame."""
    payload = b"".join(name.to_bytes(2, "big") + value.to_bytes(4, "big") for name, value in values.items())
    return write_frame(Kind.SETTINGS, 0, 0, payload)


def header_block(headers: list[tuple[str, str]]) -> bytes:
    """Return headers encoded by HPACK without its dynamic table, so that the encoding needs no state."""
    return Encoder().encode([NeverIndexedHeaderTuple(*header) for header in headers], huffman=False)


def read_settings(payload: bytes) -> Iterator[tuple[int, int]]:
    """Yield the parameters and values of a SETTINGS frame; a FrameError if its length is wrong."""
    if len(payload) % 6:
        raise FrameError(Code.FRAME_SIZE_ERROR, "sent a SETTINGS frame of a wrong length")
    for at in range(0, len(payload), 6):
        yield int.from_bytes(payload[at : at + 2], "big"), int.from_bytes(payload[at + 2 : at + 6], "big")


def without_padding(frame: Frame) -> bytes:
    """Return the content of a DATA or HEADERS frame without padding and priority.

    Raises:
        FrameError: The frame is too short for its padding or priority.
    """
    payload, padding = frame.payload, 0
    if not frame.flags & PADDED_OR_PRIORITY:
        return payload
    if frame.flags & Flag.PADDED:
        if not payload:
            raise FrameError(Code.FRAME_SIZE_ERROR, "sent a padded frame without a length of padding")
        padding, payload = payload[0], payload[1:]
    if frame.kind == Kind.HEADERS and frame.flags & Flag.PRIORITY:
        if len(payload) < 5:
            raise FrameError(
                Code.FRAME_SIZE_ERROR, "sent a HEADERS frame without the priority that it announced"
            )
        payload = payload[5:]
    if padding > len(payload):
        raise FrameError(Code.PROTOCOL_ERROR, "sent more padding than the frame has bytes")
    return payload[: len(payload) - padding]


class FrameReader:
    """Splits a client's data into frames as it arrives. It buffers less than one frame."""

    def __init__(self) -> None:
        self._rest = b""  # the incomplete frame or preface at the end of the data
        self._has_preface = False  # whether the preface was read

    def feed(self, content: bytes) -> Iterator[Frame]:
        """Yield the frames that are now complete; a FrameError if one is too large or it is not HTTP/2."""
        content, at = (self._rest + content if self._rest else content), 0
        self._rest = b""
        if not self._has_preface:
            if not content.startswith(PREFACE[: len(content)]):
                raise FrameError(Code.PROTOCOL_ERROR, "sent something else than HTTP/2")
            if len(content) < len(PREFACE):
                self._rest = content
                return
            self._has_preface, at = True, len(PREFACE)
        while (body := at + HEADER) <= len(content):
            end = body + int.from_bytes(content[at : at + 3], "big")
            if end - body > MAX_PAYLOAD:
                raise FrameError(Code.FRAME_SIZE_ERROR, f"sent a frame of {end - body:,} bytes")
            if end > len(content):
                break
            stream = int.from_bytes(content[at + 5 : body], "big") & 0x7FFF_FFFF
            yield Frame(content[at + 3], content[at + 4], stream, content[body:end])
            at = end
        self._rest = content[at:]

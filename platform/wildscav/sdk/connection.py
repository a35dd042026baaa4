"""One seat's stream to the match server.

The blocking gRPC client, not the asyncio one: agents block in ``act`` anyway, and with ten agents a match
it was 10 % faster (one agent: 5 % slower).
"""

import queue
from collections.abc import Iterator
from types import TracebackType
from typing import Self

import grpc

from wildscav.errors import ServerUnreachableError
from wildscav.proto.match_pb2 import ClientMessage, MatchOver, ServerMessage
from wildscav.sdk.agent import Action, MatchInfo, Observation
from wildscav.wire.actions import encode_action
from wildscav.wire.errors import decode_error
from wildscav.wire.matches import decode_match_info, encode_join
from wildscav.wire.observations import decode_observation

METHOD = "/wildscav.match.v1.Match/Play"
CONNECT_TIMEOUT = 5.0  # s
CHANNEL_OPTIONS = (
    ("grpc.max_receive_message_length", -1),  # sensors may be large, and the server is trusted
    ("grpc.enable_http_proxy", 0),
)


class Connection:
    """A seat taken in a match. Use as a context manager; closing it leaves the seat.

    Args:
        address: ``host:port`` or ``unix:/path``.
        token: The seat's token.
        sdk_version: Told to the server.

    Raises:
        ServerUnreachableError: No server answers, or the connection was lost.
        RefusedError: The server does not give the seat.
    """

    match: MatchInfo
    over: MatchOver  # there once the match has ended

    def __init__(self, address: str, token: str, sdk_version: str) -> None:
        self._address = address
        self._outbox: queue.SimpleQueue[ClientMessage | None] = queue.SimpleQueue()
        self._channel = grpc.insecure_channel(address, options=CHANNEL_OPTIONS)
        try:
            self._open(token, sdk_version)
        except BaseException:
            self.close()
            raise

    def _open(self, token: str, sdk_version: str) -> None:
        try:
            grpc.channel_ready_future(self._channel).result(CONNECT_TIMEOUT)
        except grpc.FutureTimeoutError:
            raise ServerUnreachableError(f"no match server answers at {self._address}") from None
        play = self._channel.stream_stream(
            METHOD,
            request_serializer=ClientMessage.SerializeToString,
            response_deserializer=ServerMessage.FromString,
        )
        self._outbox.put(encode_join(token, "wildscav-python", sdk_version))
        self._responses: Iterator[ServerMessage] = play(iter(self._outbox.get, None))
        message = self._receive()
        if message is None or not message.HasField("match_info"):
            raise ServerUnreachableError(f"{self._address} did not answer as a match server does")
        self.match = decode_match_info(message.match_info)

    def _receive(self) -> ServerMessage | None:
        try:
            return next(self._responses, None)
        except grpc.RpcError as error:
            raise decode_error(error, self._address) from None

    def next(self) -> Observation | None:
        """Wait for the next observation; None is the end of the match, told in ``over``."""
        message = self._receive()
        if message is None:
            raise ServerUnreachableError(f"{self._address} closed the connection before the match was over")
        if message.HasField("match_over"):
            self.over = message.match_over
            return None
        return decode_observation(message.observation, self.match.frames_per_second)

    def answer(self, step: int, action: Action) -> None:
        """Send the action for a step."""
        self._outbox.put(encode_action(step, action))

    def close(self) -> None:
        """End the stream and the connection."""
        self._outbox.put(None)
        self._channel.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

"""One seat's stream to the match server.

It uses gRPC's asyncio client, which has fewer threads than the blocking client: with ten agents on two cores,
steps were 30 to 50 % faster (with one agent, equally fast).
"""

import asyncio
from typing import Any, Self

import grpc

from wildscav.agent import Action, MatchInfo, Observation
from wildscav.errors import ServerUnreachableError
from wildscav.proto.match_pb2 import ClientMessage, MatchOver, Ready, ServerMessage
from wildscav.sdk.credentials import Credentials, explain_tls_failure
from wildscav.wire.actions import encode_action
from wildscav.wire.errors import decode_error
from wildscav.wire.matches import decode_match_info, encode_join
from wildscav.wire.observations import decode_observation

METHOD = "/wildscav.match.v1.Match/Play"
CONNECT_TIMEOUT = 5.0  # s
NOT_ENCRYPTED = Credentials()
LONG_SILENCE = 0.05  # s without a message after which pending events are handled before writing
CHANNEL_OPTIONS = (
    ("grpc.max_receive_message_length", -1),  # readings of sensors may be large, and the server is trusted
    ("grpc.enable_http_proxy", 0),
)


class Connection:
    """A seat in a match. Use it as an asynchronous context manager; leaving the context leaves the seat.

    Args:
        address: ``host:port`` or ``unix:/path``.
        credentials: For TLS; by default, the connection is not encrypted.

    Raises:
        ServerUnreachableError: No server answers, or the connection was lost.
        RefusedError: The server refuses the seat.
    """

    match: MatchInfo
    over: MatchOver  # set when the match has ended

    def __init__(
        self, address: str, token: str, sdk_version: str, credentials: Credentials = NOT_ENCRYPTED
    ) -> None:
        self._address, self._credentials = address, credentials
        self._join = encode_join(token, "wildscav-python", sdk_version)

    async def __aenter__(self) -> Self:
        self._loop = asyncio.get_running_loop()
        credentials = self._credentials.channel()
        self._channel = (
            grpc.aio.insecure_channel(self._address, options=CHANNEL_OPTIONS)
            if credentials is None
            else grpc.aio.secure_channel(self._address, credentials, options=CHANNEL_OPTIONS)
        )
        try:
            message = await self._open()
            if not message.HasField("match_info"):
                raise ServerUnreachableError(f"{self._address} did not answer as a match server does")
        except BaseException:
            await self._channel.close()
            raise
        self.match = decode_match_info(message.match_info)
        return self

    async def _open(self) -> ServerMessage:
        await self._connect()
        play = self._channel.stream_stream(
            METHOD,
            request_serializer=ClientMessage.SerializeToString,
            response_deserializer=ServerMessage.FromString,
        )
        self._call = play()
        self._last_heard = self._loop.time()  # when the last message arrived
        return await self._exchange(self._join)

    async def _connect(self) -> None:
        """Wait until the connection is established; if TLS prevents it, find out why."""
        if self._credentials.ca:
            await self._check_tls()  # before gRPC tries, because gRPC would log a failure itself
        try:
            async with asyncio.timeout(CONNECT_TIMEOUT):
                state = self._channel.get_state(try_to_connect=True)
                while state != grpc.ChannelConnectivity.READY:
                    await self._channel.wait_for_state_change(state)
                    state = self._channel.get_state(try_to_connect=True)
                    if state == grpc.ChannelConnectivity.TRANSIENT_FAILURE:
                        await self._check_tls()
        except TimeoutError:
            raise ServerUnreachableError(f"no match server answers at {self._address}") from None

    async def _check_tls(self) -> None:
        why = await asyncio.to_thread(explain_tls_failure, self._address, self._credentials)
        if why:
            raise ServerUnreachableError(f"no match server answers at {self._address}{why}")

    async def _exchange(self, message: ClientMessage) -> ServerMessage:
        """Send a message and wait for the next one."""
        if self._loop.time() - self._last_heard > LONG_SILENCE:
            # The loop has handled no events while the agent computed. If the server has ended the stream
            # meanwhile, writing would fail and hide the server's reason.
            await asyncio.sleep(0.001)
        try:
            await self._call.write(message)
        except asyncio.InvalidStateError:
            pass  # the stream has ended; reading reports why
        except grpc.RpcError as error:
            raise decode_error(error, self._address) from None
        return await self._read()

    async def _read(self) -> ServerMessage:
        try:
            message: Any = await self._call.read()
        except grpc.RpcError as error:
            raise decode_error(error, self._address) from None
        if not isinstance(message, ServerMessage):
            raise ServerUnreachableError(f"{self._address} closed the connection before the match was over")
        self._last_heard = self._loop.time()
        return message

    async def first(self) -> Observation | None:
        """Report that the agent is ready, and wait for the first observation; None if the match is over."""
        return self._decode(await self._exchange(ClientMessage(ready=Ready())))

    async def answer(self, step: int, action: Action) -> Observation | None:
        """Send the action for a step and wait for the next observation; None once the match is ``over``."""
        return self._decode(await self._exchange(encode_action(step, action)))

    def _decode(self, message: ServerMessage) -> Observation | None:
        if message.HasField("match_over"):
            self.over = message.match_over
            return None
        return decode_observation(message.observation, self.match.frames_per_second)

    async def __aexit__(self, *_: object) -> None:
        await self._channel.close()

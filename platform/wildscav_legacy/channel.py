"""The connection to a client: one unary method that is called repeatedly."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from wildscav.errors import WildscavError
from wildscav_legacy.commander_pb2 import Reply

if TYPE_CHECKING:
    import grpc

METHOD = "/fps_command.Commander/Request_S2A_UpdateGame"
CONNECT_TIMEOUT = 10.0  # s that a client may take to listen
LARGEST = 2**20  # bytes of a reply; actions or set-ups of 1,000 agents are less than a tenth of it
OUR_SIDE = (
    "CLIENT: "  # gRPC's prefix for a limit on our side: we are the client, the game's client is the server
)
OPTIONS = (
    ("grpc.max_send_message_length", -1),
    ("grpc.max_receive_message_length", LARGEST),
    ("grpc.enable_http_proxy", 0),  # the client is on this machine or on a named one
)


class ClientGoneError(WildscavError):
    """The client no longer answers, or never has."""


class TooLargeError(WildscavError):
    """The client does not accept a message as large as the episode needs, or its reply is too large."""


class Client:
    """A client of the original game. It is the server of this connection.

    Args:
        address: HOST:PORT.
        timeout: How long to wait until it listens, s.

    Raises:
        ClientGoneError: Nothing listens there.
    """

    def __init__(self, address: str, timeout: float = CONNECT_TIMEOUT) -> None:
        import grpc

        self.address = address
        self._gone: Callable[[], object] | None = None
        self._error = grpc.RpcError
        self._channel = grpc.insecure_channel(address, options=OPTIONS)
        try:
            grpc.channel_ready_future(self._channel).result(timeout=timeout)
        except grpc.FutureTimeoutError:
            self.close()
            raise ClientGoneError(
                f"no client answers on {address}: Game.init() must listen there before it starts this program"
            ) from None
        self._call = self._channel.unary_unary(METHOD, response_deserializer=Reply.FromString)

    def on_gone(self, callback: Callable[[], object]) -> None:
        """Call a function, in another thread, if the client disappears while it is ``watched``."""
        self._gone = callback

    @contextmanager
    def watched(self) -> Iterator[None]:
        """Watch whether the client disappears during the block; ``ask`` notices that without watching.

        It is not watched all the time, because then every message wakes a thread, which takes a quarter of
        the message's processor time.
        """
        self._channel.subscribe(self._state_changed)
        try:
            yield
        finally:
            self._channel.unsubscribe(self._state_changed)

    def _state_changed(self, state: "grpc.ChannelConnectivity") -> None:
        if state.name != "READY" and self._gone is not None:
            self._gone()

    def ask(self, request: bytes) -> Reply:
        """Send a serialized ``Request``, and wait for the reply without a time limit.

        Raises:
            ClientGoneError: The client has gone.
            TooLargeError: It cannot take the request, or its reply is too large.
        """
        try:
            reply: Reply = self._call(request)
        except self._error as error:
            raise self._explain(error, len(request)) from None
        return reply

    def _explain(self, error: Exception, size: int) -> WildscavError:
        import grpc

        call: Any = error  # the error of a call is also the call
        if call.code() is grpc.StatusCode.UNAVAILABLE:
            return ClientGoneError(f"the client on {self.address} has gone")
        if call.code() is grpc.StatusCode.RESOURCE_EXHAUSTED and OUR_SIDE in str(call.details()):
            most = f"{LARGEST >> 20} MiB"
            return TooLargeError(
                f"the client on {self.address} sent a reply of more than {most}: {call.details()}"
            )
        if call.code() is grpc.StatusCode.RESOURCE_EXHAUSTED:
            return TooLargeError(
                f"the client on {self.address} does not accept a message of {size / 1e6:.1f} MB, "
                f"so it has to ask for fewer agents or supplies: {call.details()}"
            )
        return ClientGoneError(f"the client on {self.address} failed: {call.code().name}: {call.details()}")

    def close(self) -> None:
        """Close the connection."""
        self._channel.close()

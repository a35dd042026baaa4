"""The connection to a client: one unary method, called again and again."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from wildscav.errors import WildscavError
from wildscav.legacy.commander_pb2 import Reply

if TYPE_CHECKING:
    import grpc

METHOD = "/fps_command.Commander/Request_S2A_UpdateGame"
PATIENCE = 10.0  # s that a client may take to listen
LARGEST = 2**20  # bytes of a reply: what 1,000 agents do, or how each of them begins, is less than a tenth
OURS = "CLIENT: "  # how gRPC says which side did not take a message: here, the game's client is the server
OPTIONS = (
    ("grpc.max_send_message_length", -1),
    ("grpc.max_receive_message_length", LARGEST),
    ("grpc.enable_http_proxy", 0),  # the client is on this machine, or on one that was named
)


class ClientGoneError(WildscavError):
    """The client does not answer, or never did."""


class TooLargeError(WildscavError):
    """The client does not take a message as large as the episode needs, or its reply is too large."""


class Client:
    """A client of the original game, which serves us.

    Args:
        address: HOST:PORT.

    Raises:
        ClientGoneError: Nothing listens there.
    """

    def __init__(self, address: str, patience: float = PATIENCE) -> None:
        import grpc

        self.address = address
        self._gone: Callable[[], object] | None = None
        self._error = grpc.RpcError
        self._channel = grpc.insecure_channel(address, options=OPTIONS)
        try:
            grpc.channel_ready_future(self._channel).result(timeout=patience)
        except grpc.FutureTimeoutError:
            self.close()
            raise ClientGoneError(
                f"no client answers on {address}: Game.init() starts this program when it listens there"
            ) from None
        self._call = self._channel.unary_unary(METHOD, response_deserializer=Reply.FromString)

    def when_gone(self, gone: Callable[[], object]) -> None:
        """Have a function called, in a thread of its own, if the client goes while it is ``watched``."""
        self._gone = gone

    @contextmanager
    def watched(self) -> Iterator[None]:
        """Watch for the client's end while nothing is asked of it; a question hears of that by itself.

        Not all the time: whoever watches is woken by every message, a quarter of its processor time.
        """
        self._channel.subscribe(self._look)
        try:
            yield
        finally:
            self._channel.unsubscribe(self._look)

    def _look(self, state: "grpc.ChannelConnectivity") -> None:
        if state.name != "READY" and self._gone is not None:
            self._gone()

    def ask(self, request: bytes) -> Reply:
        """Send a request, and wait for the reply for as long as the client wants to think.

        Args:
            request: A ``Request`` as bytes.

        Raises:
            ClientGoneError: The client has gone.
            TooLargeError: It cannot take the request, or its reply is too large.
        """
        try:
            reply: Reply = self._call(request)
        except self._error as error:
            raise self._what_happened(error, len(request)) from None
        return reply

    def _what_happened(self, error: Exception, size: int) -> WildscavError:
        import grpc

        call: Any = error  # every error of a call is one, too
        if call.code() is grpc.StatusCode.UNAVAILABLE:
            return ClientGoneError(f"the client on {self.address} has gone")
        if call.code() is grpc.StatusCode.RESOURCE_EXHAUSTED and OURS in str(call.details()):
            most = f"{LARGEST >> 20} MiB"
            return TooLargeError(
                f"the client on {self.address} sent a reply of more than {most}: {call.details()}"
            )
        if call.code() is grpc.StatusCode.RESOURCE_EXHAUSTED:
            return TooLargeError(
                f"the client on {self.address} takes no message of {size / 1e6:.1f} MB, "
                f"so it has to ask for fewer agents or supplies: {call.details()}"
            )
        return ClientGoneError(f"the client on {self.address} failed: {call.code().name}: {call.details()}")

    def close(self) -> None:
        """Let go of the connection."""
        self._channel.close()

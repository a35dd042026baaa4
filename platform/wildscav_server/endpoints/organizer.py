"""Authentication of organizers: with the secret of the server, if it has one, to open matches."""

import hmac

import grpc

from wildscav.errors import UserError
from wildscav.wire.errors import RefusalError
from wildscav_server.endpoints.addresses import is_public
from wildscav_server.http2.stream import Stream


class Organizer:
    """Authenticates organizers by the secret that calls must carry; without one, all are accepted."""

    def __init__(self, token: str | None) -> None:
        self._token = token

    def admit(self, stream: Stream) -> None:
        """Mark a call's client as known, or raise a RefusalError if it lacks the organizers' secret."""
        if self._token is not None:
            given = stream.headers.get("authorization", "").removeprefix("Bearer ")
            if not hmac.compare_digest(given.encode(), self._token.encode()):
                raise RefusalError(
                    grpc.StatusCode.UNAUTHENTICATED,
                    "ORGANIZER_TOKEN",
                    "this call needs the organizer's token",
                )
        stream.mark_authenticated()

    def check_address(self, address: str) -> None:
        """Raise a UserError for an address where other machines could open matches without a token."""
        if self._token is None and is_public(address):
            raise UserError(
                f"{address} can be reached from other machines: give an organizer token "
                "(--organizer-token-file), or listen on 127.0.0.1 or a unix socket",
                exit_code=2,
            )

"""Who may open matches on a shared server: whoever has its secret, or everyone where there is none."""

import hmac

import grpc

from wildscav.errors import UserError
from wildscav.server.endpoints.addresses import is_public
from wildscav.server.http2.stream import Stream
from wildscav.wire.errors import RefusalError


class Organizer:
    """Tells organizers from others.

    Args:
        token: The secret that every call must carry; None: nobody is asked.
    """

    def __init__(self, token: str | None) -> None:
        self._token = token

    def admit(self, stream: Stream) -> None:
        """Let an organizer's call pass.

        Raises:
            RefusalError: It does not carry the secret.
        """
        if self._token is not None:
            given = stream.headers.get("authorization", "").removeprefix("Bearer ")
            if not hmac.compare_digest(given.encode(), self._token.encode()):
                raise RefusalError(
                    grpc.StatusCode.UNAUTHENTICATED,
                    "ORGANIZER_TOKEN",
                    "this call needs the organizer's token",
                )
        stream.trust()

    def check_address(self, address: str) -> None:
        """Let a server listen for organizers at an address.

        Raises:
            UserError: Others could open matches there.
        """
        if self._token is None and is_public(address):
            raise UserError(
                f"{address} can be reached from other machines: name an organizer token "
                "(--organizer-token-file), or listen on 127.0.0.1 or a unix socket",
                exit_code=2,
            )

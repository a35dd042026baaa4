"""The names that a site on this machine is asked for by."""

import socket
from ipaddress import ip_address
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send


class OwnNames:
    """Middleware that refuses requests by another name than the host's.

    Whoever owns another name could lead it here, to have foreign pages read.
    """

    def __init__(self, app: ASGIApp, host: str) -> None:
        self._app = app
        machine = socket.gethostname().lower()
        self._names = {host.lower(), "localhost", machine, f"{machine}.local"}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        is_own = self._is_own(Headers(scope=scope).get("host", ""))
        app = self._app if is_own else PlainTextResponse("this is not the name of this site\n", 400)
        await app(scope, receive, send)

    def _is_own(self, told: str) -> bool:
        """Return whether a header Host has an address, or a name of this machine."""
        try:
            name = urlsplit(f"//{told}").hostname or ""
            return name in self._names or bool(ip_address(name))
        except ValueError:
            return False

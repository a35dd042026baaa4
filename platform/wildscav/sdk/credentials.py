"""TLS credentials of a client, and diagnosis of failed TLS connections."""

import os
import socket
import ssl
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import grpc

from wildscav.errors import UserError, describe

CA_VARIABLE, CERT_VARIABLE, KEY_VARIABLE = "WILDSCAV_CA", "WILDSCAV_CERT", "WILDSCAV_KEY"
PROBE_TIME = 3.0  # s


class Credentials(NamedTuple):
    """PEM files for TLS. Without ``ca``, a connection is not encrypted."""

    ca: str = ""  # the authority that signed the server's certificate
    cert: str = ""  # the client's own certificate, if the server requires one
    key: str = ""  # its private key

    @classmethod
    def of(cls, environment: Mapping[str, str] = os.environ) -> "Credentials":
        """Return the credentials that environment variables name.

        Raises:
            UserError: A file cannot be read, or another file that it needs is not named.
        """
        named = cls(*(environment.get(name, "") for name in (CA_VARIABLE, CERT_VARIABLE, KEY_VARIABLE)))
        if bool(named.cert) != bool(named.key):
            raise UserError(
                f"{CERT_VARIABLE} and {KEY_VARIABLE} belong together: set both or neither", exit_code=2
            )
        if named.cert and not named.ca:
            raise UserError(
                f"{CERT_VARIABLE} needs {CA_VARIABLE}, the authority that signed the server's certificate",
                exit_code=2,
            )
        if named.ca:
            named.context()
        return named

    def context(self) -> ssl.SSLContext:
        """Return the credentials for Python's own TLS, or raise a UserError if a file is invalid."""
        for path in filter(None, self):
            read_credential(path)
        try:
            context = ssl.create_default_context(cafile=self.ca)
            context.set_alpn_protocols(["h2"])
            if self.cert:
                context.load_cert_chain(self.cert, self.key, password="")
        except ssl.SSLError as error:
            files = ", ".join(filter(None, self))
            raise UserError(
                f"{files}: not certificates and a key in PEM ({error.reason})", exit_code=2
            ) from None
        return context

    def channel(self) -> grpc.ChannelCredentials | None:
        """Return the credentials for gRPC; None for a connection that is not encrypted."""
        if not self.ca:
            return None
        own = [read_credential(path) for path in (self.key, self.cert) if path]
        credentials: grpc.ChannelCredentials = grpc.ssl_channel_credentials(read_credential(self.ca), *own)
        return credentials


def read_credential(path: str) -> bytes:
    """Return the content of a file, or raise a UserError if it cannot be read."""
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise UserError(f"cannot read {describe(error)}", exit_code=2) from None


def explain_tls_failure(address: str, credentials: Credentials) -> str:
    """Return why TLS fails at an address, as the end of an error message; "" if it does not fail.

    gRPC itself reports only that there is no connection.
    """
    if address.startswith("unix:"):
        return ""
    host, _, port = address.rpartition(":")
    host = host.removeprefix("[").removesuffix("]")
    context = credentials.context() if credentials.ca else _any_server()
    try:
        with (
            socket.create_connection((host, int(port)), PROBE_TIME) as plain,
            context.wrap_socket(plain, server_hostname=host) as encrypted,
        ):
            is_accepted = _is_accepted(encrypted)
    except ssl.SSLCertVerificationError as error:
        return f": its certificate is not accepted ({error.verify_message or error.reason})"
    except ssl.SSLError as error:
        reason = (error.reason or str(error)).lower().replace("_", " ")
        return f": it does not speak TLS as it should ({reason})" if credentials.ca else ""
    except (OSError, ValueError):
        return ""
    if not credentials.ca:
        return f": it uses TLS; name its authority with --ca or {CA_VARIABLE}"
    if not is_accepted:
        problem = "the one given is not accepted" if credentials.cert else "none is given"
        return f": it requires a client's certificate, and {problem} (--cert, --key)"
    return ""


def _is_accepted(encrypted: ssl.SSLSocket) -> bool:
    """Return whether a server sends data: it rejects a client's certificate only after the handshake."""
    try:
        return bool(encrypted.recv(1))
    except OSError:
        return False


def _any_server() -> ssl.SSLContext:
    """Return a context that accepts any server, only to find out whether it uses TLS."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    context.set_alpn_protocols(["h2"])
    return context

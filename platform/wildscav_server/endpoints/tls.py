"""TLS of a server: its certificate, and the authority of its clients' certificates."""

import ssl
from typing import NamedTuple

from wildscav.errors import UserError
from wildscav.sdk.credentials import read_credential


class Certificate(NamedTuple):
    """The PEM files of a server's TLS."""

    chain: str  # the server's certificate, followed by those of its authorities
    key: str
    client_ca: str | None = None  # the authority of clients' certificates; None: clients need none

    def context(self) -> ssl.SSLContext:
        """Read the files, or raise a UserError if that fails or certificate and key do not fit."""
        for path in filter(None, self):
            read_credential(path)
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.minimum_version = ssl.TLSVersion.TLSv1_2
        context.options |= ssl.OP_NO_RENEGOTIATION
        context.set_alpn_protocols(["h2"])
        try:
            context.load_cert_chain(self.chain, self.key, password=_no_password)
        except (ssl.SSLError, ValueError) as error:
            raise UserError(
                f"{self.chain} and {self.key} are not a certificate and its key: {_reason(error)}",
                exit_code=2,
            ) from None
        if self.client_ca is not None:
            context.verify_mode = ssl.CERT_REQUIRED
            try:
                context.load_verify_locations(self.client_ca)
            except ssl.SSLError as error:
                raise UserError(
                    f"{self.client_ca} contains no certificate: {_reason(error)}", exit_code=2
                ) from None
        return context


def _no_password() -> str:
    raise ValueError("the key is encrypted, and a server cannot ask for its password")


def _reason(error: Exception) -> str:
    if isinstance(error, ssl.SSLError):
        return (error.reason or str(error)).lower().replace("_", " ")
    return str(error)

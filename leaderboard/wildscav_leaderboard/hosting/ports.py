"""What the web server needs of this machine: a port, and the certificate for TLS."""

import socket
import ssl

from wildscav.errors import UserError, describe
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.settings import SETTINGS_FILE


def check_port(host: str, port: int) -> int:
    """Check that a server can listen on a port, and return its number; for 0, that of a free one.

    Raises:
        UserError: It cannot: something else listens there, or it is not allowed to.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise UserError(f"port {port} of {host} cannot be used: {describe(error)}") from error
        return int(probe.getsockname()[1])


def check_certificate(season: Season) -> None:
    """Check the certificate of a season's settings and its key, if they name them.

    Raises:
        UserError: They cannot be read, or do not belong together.
    """
    web = season.settings.web
    if web.certificate is None or web.key is None:
        return
    certificate, key = season.folder / web.certificate, season.folder / web.key
    try:
        ssl.create_default_context(ssl.Purpose.CLIENT_AUTH).load_cert_chain(certificate, key)
    except OSError as error:
        what = f"{certificate} and {key} cannot be used for TLS: {error.strerror or error}"
        raise UserError(f"{season.folder / SETTINGS_FILE}: web.certificate: {what}", exit_code=2) from error

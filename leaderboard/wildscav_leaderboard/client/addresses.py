"""Addresses of seasons, as people type them."""

from ipaddress import ip_address
from urllib.parse import urlsplit

from wildscav.errors import UserError

PORTS = {"http": 80, "https": 443}


def season_url(text: str) -> str:
    """Return the address of a season, such as ``https://season.example.org``.

    Without a scheme, it is https; http for this machine.

    Raises:
        UserError: It is no address of a season.
    """
    text = text.strip()
    scheme, _, rest = text.rpartition("://")
    try:
        parts = urlsplit(f"{scheme or 'https'}://{rest}")
        host, port = parts.hostname, parts.port
    except ValueError:
        host = port = None
    if not host or parts.scheme not in PORTS or not text.isprintable() or " " in text:
        raise UserError(f"{text!r} is no address of a season, such as https://season.example.org", 2)
    if parts.username is not None or parts.path.strip("/") or parts.query or parts.fragment:
        raise UserError(
            f"{text!r} is more than the address of a season: give only its host, such as "
            f"{parts.scheme}://{host}",
            exit_code=2,
        )
    chosen = parts.scheme if scheme or not is_this_machine(host) else "http"
    shown = f"[{host}]" if ":" in host else host
    return f"{chosen}://{shown}" + ("" if port in (None, PORTS[chosen]) else f":{port}")


def is_this_machine(host: str) -> bool:
    """Return whether a host is this machine's own."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost" or host.endswith(".localhost")


def is_open_to_others(url: str) -> bool:
    """Return whether others on the way to an address can read what is sent there."""
    parts = urlsplit(url)
    return parts.scheme == "http" and not is_this_machine(parts.hostname or "")

"""Connecting to a Ray cluster, and explaining in one line why that failed."""

import logging
import os
import re
import secrets
import socket
from pathlib import Path

from wildscav_evaluator.executors.base import ExecutorError

VERSIONS = re.compile(r"Ray: (\S+)\s+Python: (\S+)")
CLIENT = "ray://"
REACH_TIME = 5.0  # s for a connection to the address
TOKEN_FILE = Path("~/.ray/auth_token")  # written by `ray start --head`
TOKEN_VARIABLES = ("RAY_AUTH_TOKEN", "RAY_AUTH_TOKEN_PATH")


def connect(address: str | None) -> None:
    """Connect this process to a cluster, without anything that Ray would print or report about its users.

    Without an address, it is ``RAY_ADDRESS`` or this machine's cluster. ExecutorError, in one line, if it
    cannot be used.
    """
    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
    _use_token()
    import ray

    where = address or os.environ.get("RAY_ADDRESS") or "auto"
    check_address(where)
    try:
        ray.init(
            where,
            namespace=f"wildscav-{secrets.token_hex(8)}",
            log_to_driver=False,
            configure_logging=False,
            logging_level=logging.CRITICAL,
        )
    except Exception as error:  # Ray raises whatever its parts raise
        raise ExecutorError(_reason(where, error)) from error


def _use_token() -> None:
    """Present this user's token to clusters if there is one; Ray asks for it by default but sends none.

    A cluster that asks for no token ignores it. Ray reads this when it is imported.
    """
    if any(name in os.environ for name in TOKEN_VARIABLES) or TOKEN_FILE.expanduser().is_file():
        os.environ.setdefault("RAY_AUTH_MODE", "token")


def check_address(address: str) -> None:
    """Refuse an address where nothing listens, for which Ray would wait a minute."""
    if address == "auto":
        return
    host, _, port = address.removeprefix(CLIENT).rpartition(":")
    if not host or not port.isdecimal() or not 0 < int(port) < 65_536 or "/" in host:
        allowed = f"HOST:PORT or {CLIENT}HOST:PORT"
        raise ExecutorError(f"--address {address} is no address of a Ray cluster: must be {allowed}", 2)
    try:
        socket.create_connection((host.strip("[]"), int(port)), REACH_TIME).close()
    except OSError as error:
        raise ExecutorError(f"there is no Ray cluster at {address}: {error.strerror or error}") from None


def _reason(where: str, error: Exception) -> str:
    """Return in one line why a cluster cannot be used."""
    chain: list[BaseException] = [error]
    while cause := chain[-1].__cause__ or chain[-1].__context__:
        chain.append(cause)
    text = "\n".join(str(one) for one in chain)
    versions = VERSIONS.findall(text)
    if len(versions) >= 2:
        (ray_there, python_there), (ray_here, python_here) = versions[:2]
        return (
            f"the Ray cluster at {where} runs Ray {ray_there} with Python {python_there}, but here are "
            f"Ray {ray_here} and Python {python_here}: both must be the same on all machines"
        )
    if re.search(r"auth\w*\W?token", text, re.IGNORECASE):
        return (
            f"the Ray cluster at {where} asks for another authentication token: copy ~/.ray/auth_token from "
            "the machine where `ray start --head` ran, or set RAY_AUTH_TOKEN or RAY_AUTH_TOKEN_PATH"
        )
    if where == "auto":
        return "no Ray cluster runs on this machine: run `ray start --head`, or name a cluster with --address"
    return f"the Ray cluster at {where} cannot be used: {' '.join(str(error).split())[:300]}"

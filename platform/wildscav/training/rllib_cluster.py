"""Where RLlib runs: in a Ray of its own on this machine, or on a cluster by its address."""

import gc
import importlib.util
import logging
import os
import re
import secrets
import socket
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from wildscav.errors import UserError

REACH_TIME = 5.0  # s for a connection to the address
TOKEN_FILE = Path("~/.ray/auth_token")  # written by `ray start --head`
TOKEN_VARIABLES = ("RAY_AUTH_TOKEN", "RAY_AUTH_TOKEN_PATH")
SHOWN = 200  # characters of an error of Ray


def check_address(address: str) -> None:
    """Refuse an address where nothing listens, for which Ray would wait a minute.

    Raises:
        UserError: It is no address, or nothing listens there.
    """
    host, _, port = address.rpartition(":")
    if not host or not port.isdecimal() or not 0 < int(port) < 65_536 or "/" in host:
        raise UserError(f"--address {address} is no address of a Ray cluster: must be HOST:PORT", exit_code=2)
    try:
        socket.create_connection((host.strip("[]"), int(port)), REACH_TIME).close()
    except OSError as error:
        raise UserError(f"there is no Ray cluster at {address}: {error.strerror or error}") from None


@contextmanager
def connected(address: str | None, processes: int) -> Iterator[None]:
    """Connect to a cluster, or start Ray here, without anything that Ray would print or report.

    Args:
        address: ``HOST:PORT``; None for this machine alone.
        processes: That play matches beside this one.

    Raises:
        UserError: Ray is not installed, or there is no cluster that can be used.
    """
    if importlib.util.find_spec("ray") is None:
        raise UserError("RLlib needs the module ray; install it with: pip install 'wildscav[training]'")
    if address is not None:
        check_address(address)
    _set_environment(address)
    with warnings.catch_warnings(), tempfile.TemporaryDirectory(prefix="wildscav-rllib-") as folder:
        warnings.simplefilter("ignore")  # Ray warns of its own future
        import ray
        import ray.rllib
        from ray.tune.trainable import trainable

        trainable.DEFAULT_STORAGE_PATH = folder  # else RLlib leaves folders in ~/ray_results
        for name in ("ray", "ray.rllib"):
            logging.getLogger(name).setLevel(logging.CRITICAL)
        _start(address, processes)
        try:
            yield
        finally:
            ray.shutdown()
            gc.collect()  # it forgets its processes without waiting, of which Python warns: here nobody hears


def _set_environment(address: str | None) -> None:
    """Set the variables that Ray reads when it is imported."""
    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
    os.environ["RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO"] = "0"
    os.environ.setdefault("RAY_worker_niceness", "0")  # those that play are as urgent as the one that learns
    known = any(name in os.environ for name in TOKEN_VARIABLES) or TOKEN_FILE.expanduser().is_file()
    if address is None and not known:
        os.environ["RAY_AUTH_TOKEN"] = secrets.token_hex(32)  # nobody else may use a Ray of its own
        known = True
    if known:
        os.environ.setdefault("RAY_AUTH_MODE", "token")


def _start(address: str | None, processes: int) -> None:
    """Connect to a cluster, or start Ray here.

    Raises:
        UserError: That failed.
    """
    import ray

    given: dict[str, Any] = {
        "log_to_driver": False,
        "configure_logging": False,
        "logging_level": logging.CRITICAL,
    }
    if address is None:
        given |= {"num_cpus": processes + 1, "include_dashboard": False}
    try:
        ray.init(address or "local", **given)
    except Exception as error:  # noqa: BLE001 - Ray raises whatever its parts raise
        where = "this machine" if address is None else address
        said = re.sub(r"\s+", " ", str(error)).strip()[:SHOWN]
        raise UserError(f"Ray at {where} cannot be used: {said}") from None

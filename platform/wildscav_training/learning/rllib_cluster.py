"""Where RLlib runs: in a Ray of its own on this machine, or on a cluster by its address."""

import gc
import importlib.util
import logging
import os
import re
import secrets
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from wildscav.errors import UserError
from wildscav_training.learning.ray_clusters import check_address, has_token, use_token

SHOWN = 200  # characters of an error of Ray


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
    if address is None and not has_token():
        os.environ["RAY_AUTH_TOKEN"] = secrets.token_hex(32)  # nobody else may use a Ray of its own
    use_token()


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

"""Connecting to a Ray cluster, and explaining in one line why that failed."""

import logging
import os
import re
import secrets

from wildscav.errors import UserError
from wildscav_evaluator.executors.base import ExecutorError
from wildscav_training.learning import ray_clusters

VERSIONS = re.compile(r"Ray: (\S+)\s+Python: (\S+)")
CLIENT = "ray://"


def connect(address: str | None) -> None:
    """Connect this process to a cluster, without anything that Ray would print or report about its users.

    Args:
        address: ``HOST:PORT`` or ``ray://HOST:PORT``; None for ``RAY_ADDRESS`` or this machine's cluster.

    Raises:
        ExecutorError: There is no cluster, or it cannot be used; the message is one line.
    """
    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
    ray_clusters.use_token()
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


def check_address(address: str) -> None:
    """Refuse an address where nothing listens, for which Ray would wait a minute.

    Raises:
        ExecutorError: It is no address, or nothing listens there.
    """
    if address == "auto":
        return
    try:
        ray_clusters.check_address(address, CLIENT)
    except UserError as error:
        raise ExecutorError(str(error), error.exit_code) from None


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

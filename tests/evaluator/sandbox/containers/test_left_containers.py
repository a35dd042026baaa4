"""Containers that Podman has lost: it started them and was killed before it had noted that."""

import asyncio
import signal
import subprocess
import time

import pytest
from tests.evaluator.sandbox.available import engine_named, missing
from tests.evaluator.sandbox.sandbox_runs import processes_with

from wildscav_evaluator.sandbox.containers import left_containers
from wildscav_evaluator.sandbox.containers.container_engine import (
    ContainerEngine,
    bare_image,
    find_engine,
    processes_of,
)
from wildscav_server import leftovers

FOLDERS = ("/dev", "/etc", "/proc", "/run", "/sys")
ATTEMPTS = 20


@pytest.mark.slow
def test_processes_of_a_container_that_podman_has_lost_are_killed(request: pytest.FixtureRequest) -> None:
    with engine_named("podman", request):
        if why := missing("oci"):
            pytest.skip(f"podman: {why}")
        engine = find_engine()
        lost = (_lose_container(engine, 0.002 * number) for number in range(ATTEMPTS))
        identity = next(filter(None, lost), "")
        if not identity:
            pytest.skip("this version of Podman loses no containers")
        assert processes_with(identity)

        left_containers.kill_left_processes(left_containers._entry(engine, identity))

        assert not processes_of(identity)
        assert not processes_with(identity)


def _lose_container(engine: ContainerEngine, seconds: float) -> str:
    """Kill Podman while it starts a container, and remove that; return its identity if processes stay.

    Args:
        engine: Podman.
        seconds: When to kill it, s after the first process of the container came up.
    """
    name = f"wildscav-{leftovers.owner()}-{time.monotonic_ns()}"
    options = ["--name", name, "--network", "none", "--init", "--ulimit", "nofile=256:256"]
    limits, command = ["--ulimit", "nproc=256:256"], ["/run/podman-init", "-P"]  # which waits for ever
    image = bare_image(engine, FOLDERS, ())
    identity = asyncio.run(engine.run("create", *options, *limits, image, *command))
    start = subprocess.Popen([*engine.command, "start", name], stderr=subprocess.DEVNULL)
    while not processes_of(identity) and start.poll() is None:
        time.sleep(0.001)
    time.sleep(seconds)
    start.send_signal(signal.SIGKILL)
    start.wait()
    left_containers.remove_left_container(left_containers._entry(engine, name))
    time.sleep(0.5)  # processes that were only dying are gone then
    return identity if processes_of(identity) else ""

"""Ray clusters for tests, in processes of their own, of which none outlives its test."""

import contextlib
import json
import os
import secrets
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

PROGRAM = Path(__file__).with_name("cluster_program.py")
MARK = "WILDSCAV_TEST_CLUSTER"  # a variable that all processes of a cluster have, their children included


class RayCluster:
    """A cluster with a head that has no cores, to which nodes are added; of any release of Ray."""

    def __init__(self, ray_version: str = "") -> None:
        self.mark, token = secrets.token_hex(8), secrets.token_hex(32)
        # Nobody else may use it: Ray runs whatever it is sent.
        self.environment = {
            **os.environ,
            "RAY_AUTH_MODE": "token",
            "RAY_AUTH_TOKEN": token,
            "RAY_USAGE_STATS_ENABLED": "0",
            "RAY_gcs_rpc_server_reconnect_timeout_s": "5",
            "RAY_health_check_period_ms": "1000",
        }
        self._process = subprocess.Popen(
            [sys.executable, str(PROGRAM)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env={**self.environment, MARK: self.mark},
        )
        self._send(network=1 + secrets.randbelow(250), ray_version=ray_version)
        self.address = self._line()

    def _send(self, **command: object) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(command) + "\n")
        self._process.stdin.flush()

    def _line(self) -> str:
        assert self._process.stdout is not None
        line = self._process.stdout.readline().strip()
        assert line, "the cluster did not start"
        return line

    def add(self, name: str, cores: int = 1, **variables: str) -> None:
        """Add a node whose processes have some more environment variables."""
        self._send(do="add", name=name, cores=cores, variables=variables)
        self._line()

    def kill(self, name: str) -> None:
        """Kill a node, or the head, with signal 9."""
        self._send(do="kill", name=name)
        self._line()

    def use(self, environment: pytest.MonkeyPatch) -> None:
        """Let this process and its children use the cluster."""
        for name, value in self.environment.items():
            if name.startswith("RAY_"):
                environment.setenv(name, value)

    def processes(self) -> list[int]:
        """Return the processes of the cluster that are alive, with all that run on its nodes."""
        found = []
        for folder in Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError):
                if f"{MARK}={self.mark}".encode() in (folder / "environ").read_bytes():
                    found.append(int(folder.name))
        return found

    def close(self) -> None:
        """End the cluster, and make sure that nothing of it is left."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(30)
        deadline = time.monotonic() + 20
        while self.processes() and time.monotonic() < deadline:
            time.sleep(0.1)
        for process in self.processes():
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()


@contextlib.contextmanager
def ray_cluster(*nodes: str, cores: int = 1, ray_version: str = "") -> Iterator[RayCluster]:
    """Run a cluster with some nodes for as long as the block lasts."""
    cluster = RayCluster(ray_version)
    try:
        for name in nodes:
            cluster.add(name, cores)
        yield cluster
    finally:
        cluster.close()

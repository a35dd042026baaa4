"""A Docker daemon for tests: the machine's own if one answers, else one of ours, with no network."""

import contextlib
import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

PATIENCE = 30.0  # s


@contextlib.contextmanager
def docker_daemon() -> Iterator[str]:
    """Yield the address of a Docker daemon.

    Raises:
        RuntimeError: There is none, and none can be started; says why.
    """
    if shutil.which("docker") is None:
        raise RuntimeError("there is no docker: install docker.io")
    own = os.environ.get("DOCKER_HOST", "unix:///var/run/docker.sock")
    if _answers(own):
        yield own
        return
    if os.getuid() != 0 or shutil.which("dockerd") is None:
        raise RuntimeError("no Docker daemon answers, and starting one takes root and dockerd (docker.io)")
    folder = Path(tempfile.mkdtemp(prefix="wildscav-docker-"))
    try:
        with _started(folder) as address:
            yield address
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@contextlib.contextmanager
def _started(folder: Path) -> Iterator[str]:
    address = f"unix://{folder}/docker.sock"
    places = ("--data-root", folder / "data", "--exec-root", folder / "exec", "--pidfile", folder / "pid")
    no_network = ("--bridge", "none", "--iptables=false", "--ip6tables=false")
    log = folder / "log"
    with log.open("wb") as output:
        command = ["dockerd", "--host", address, *map(str, places), *no_network]
        daemon = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, start_new_session=True)
    try:
        end = time.monotonic() + PATIENCE
        while not _answers(address):
            if daemon.poll() is not None or time.monotonic() > end:
                raise RuntimeError(f"dockerd does not start here: {log.read_text().splitlines()[-1]}")
            time.sleep(0.1)
        yield address
    finally:
        daemon.terminate()  # it ends what it has started, too
        daemon.wait(PATIENCE)
        for mount in (folder / "exec" / "netns").glob("*"):  # which it may leave behind
            subprocess.run(["umount", str(mount)], capture_output=True, check=False)


def _answers(address: str) -> bool:
    command = ["docker", "--host", address, "version", "--format", "{{.Server.Version}}"]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0

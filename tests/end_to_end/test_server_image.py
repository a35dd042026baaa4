"""The image of the match server, built from docker/, serves a match to an agent outside of it."""

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import grpc
import pytest
from tests.evaluator.sandbox.available import missing
from tests.evaluator.submissions.python_image import python_image
from tests.platform.helpers.seats import small_spec
from tests.ports import free_ports

from wildscav.proto.match_pb2 import GetMatchRequest, GetMatchResponse, HostMatchRequest
from wildscav.proto.match_pb2_grpc import ArenaStub
from wildscav.wire.matches import decode_seat_address
from wildscav_engine.compilation.caching.cache_root import cache_root
from wildscav_engine.record import verify_record
from wildscav_engine.record.format import decode
from wildscav_evaluator.sandbox.containers.container_engine import OWNER, ContainerEngine, call, find_engine
from wildscav_server import leftovers
from wildscav_server.hosting.precompile import precompile

pytestmark = [pytest.mark.slow, pytest.mark.long]
ROOT = Path(__file__).parents[2]
# Not in localhost/wildscav/, which the tests of submissions' images sweep.
IMAGE = f"localhost/wildscav-test-server:{os.getpid()}"
PYTHON = f"localhost/wildscav-test-server-python:{os.getpid()}"
CONTAINER = f"wildscav-test-server-{os.getpid()}"
TOKEN = "correct horse battery staple"  # noqa: S105
EVERYWHERE = "0.0.0.0:50051"  # where the image listens unless told otherwise
# Less than Podman sets for itself, which may be more than it may set here.
LIMITS = ("--ulimit", "nofile=4096:4096", "--ulimit", "nproc=4096:4096")
BUILD_PATIENCE = 400.0  # s, to fetch and install packages
START_PATIENCE = 400.0  # s, to load all kernels, or to compile them for other releases


@pytest.fixture
def engine() -> Iterator[ContainerEngine]:
    """The container engine of this machine; what the test makes with it goes afterwards."""
    if missing("oci"):
        pytest.skip(missing("oci"))
    engine = find_engine()
    yield engine
    call(engine, "rm", "--force", "--volumes", CONTAINER)
    for image in (IMAGE, PYTHON):
        call(engine, "rmi", "--force", image)


def test_the_image_of_the_server_serves_a_match(engine: ContainerEngine, tmp_path: Path) -> None:
    build(engine)
    port = free_ports(2)  # the organizers', and the worker's
    start(engine, f"127.0.0.1:{port}", tmp_path)

    answer = play(f"127.0.0.1:{port}")

    assert (answer.state, answer.steps) == (GetMatchResponse.STATE_FINISHED, 20), answer.error
    assert answer.conduct[0].status == "finished"
    assert verify_record(decode(answer.record)).holds  # the engine in the image plays as this one does
    stop = call(engine, "stop", "-t", "30", CONTAINER)
    assert (stop.returncode, asked(engine, "{{.State.ExitCode}}")) == (0, "0"), logs(engine)


def build(engine: ContainerEngine) -> None:
    """Build the image as engine.Dockerfile says, on this machine's Python."""
    python = python_image(engine, PYTHON)
    no_leftovers = ["--layers=false"] if engine.name == "podman" else []
    built = subprocess.run(
        [
            *(*engine.command, "build", "--file", "docker/engine.Dockerfile", "--target", "server"),
            *("--tag", IMAGE, "--build-arg", f"PYTHON={python}", "--network=host", *no_leftovers, "."),
        ],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=BUILD_PATIENCE,
    )
    assert built.returncode == 0, built.stdout


def start(engine: ContainerEngine, address: str, folder: Path) -> None:
    """Start the server as compose.yaml does, but on this machine's network; return when it serves."""
    inspected = call(engine, "image", "inspect", "--format", "{{json .Config.Cmd}}", IMAGE)
    command = json.loads(inspected.stdout)
    assert EVERYWHERE in command
    command[command.index("--workers") + 1] = "1"  # each loads all kernels
    (folder / "token").write_text(TOKEN)
    (folder / "token").chmod(0o644)
    started = call(
        engine,
        *("run", "--detach", "--name", CONTAINER, "--pull", "never"),
        *("--label", f"{OWNER}={leftovers.owner()}"),
        *("--read-only", "--cap-drop", "all", "--security-opt", "no-new-privileges", "--tmpfs", "/tmp"),  # noqa: S108
        *("--volume", f"{folder}/token:/run/secrets/organizer_token:ro"),
        *("--volume", f"{kernels(folder)}:/var/cache/wildscav"),
        *("--network", "host", *LIMITS),
        *(IMAGE, *(address if word == EVERYWHERE else word for word in command)),
    )
    assert started.returncode == 0, started.stderr.decode()
    end = time.monotonic() + START_PATIENCE
    while "listening on" not in logs(engine):  # which it says when its worker does
        assert asked(engine, "{{.State.Running}}") == "true", logs(engine)
        assert time.monotonic() < end, logs(engine)
        time.sleep(1.0)  # asking costs processor time, which it needs


def kernels(folder: Path) -> Path:
    """Return a cache with the code that is compiled here, to which the image's user can add."""
    precompile()
    kept = folder / "cache" / "kernels"
    with suppress(shutil.Error):  # of code that another process removes meanwhile, because it is old
        shutil.copytree(cache_root(), kept, copy_function=os.link)
    for each in (kept.parent, kept, *kept.iterdir()):
        each.chmod(0o777)
    return kept.parent


def asked(engine: ContainerEngine, about: str) -> str:
    return call(engine, "inspect", "--format", about, CONTAINER).stdout.decode().strip()


def logs(engine: ContainerEngine) -> str:
    said = call(engine, "logs", CONTAINER)
    return (said.stdout + said.stderr).decode()


def play(called: str) -> GetMatchResponse:
    """Let a submission play a match of two seconds in a process of its own; return how it ended."""
    organizer = {"metadata": (("authorization", f"Bearer {TOKEN}"),), "timeout": 30.0}
    with grpc.insecure_channel(called) as channel:
        arena = ArenaStub(channel)
        hosted = arena.HostMatch(HostMatchRequest(spec_json=small_spec().model_dump_json()), **organizer)
        seat = {
            "WILDSCAV_ADDRESS": decode_seat_address(hosted, called),
            "WILDSCAV_TOKEN": hosted.seat_tokens[0],
        }
        agent = subprocess.run(
            [sys.executable, "-m", "wildscav.sdk", "submissions/homing"],
            cwd=ROOT,
            env={**os.environ, **seat},
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert agent.returncode == 0, agent.stderr
        over = (GetMatchResponse.STATE_FINISHED, GetMatchResponse.STATE_FAILED)
        while True:
            answer: GetMatchResponse = arena.GetMatch(GetMatchRequest(match_id=hosted.match_id), **organizer)
            if answer.state in over:
                return answer
            time.sleep(0.1)

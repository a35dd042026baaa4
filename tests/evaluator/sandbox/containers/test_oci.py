"""Containers: which engine runs them, and what is said where none can."""

import asyncio
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.evaluator.sandbox.available import missing
from tests.evaluator.sandbox.sandbox_runs import LIMITS, listening, wait_until

from wildscav_evaluator.sandbox import SANDBOXES, Launch, SandboxError
from wildscav_evaluator.sandbox.containers import container_engine as engine
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server import leftovers

Submit = Callable[..., Submission]


def test_without_an_engine_it_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))

    with pytest.raises(
        SandboxError, match=r"podman is not installed; docker is not installed.*install Podman"
    ):
        engine.find_engine()


def test_an_engine_that_does_not_answer_is_passed_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "docker").write_text("#!/bin/sh\necho 'Cannot connect to the daemon' >&2\nexit 1\n")
    (tmp_path / "docker").chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))

    with pytest.raises(SandboxError, match="docker: Cannot connect to the daemon"):
        engine.find_engine()


def test_only_engines_that_there_are_can_be_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(engine.CHOICE, "lxc")

    with pytest.raises(SandboxError, match="WILDSCAV_ENGINE is 'lxc', must be one of podman, docker"):
        engine.find_engine()


@pytest.mark.slow
def test_a_container_that_cannot_be_made_leaves_nothing(submit: Submit, tmp_path: Path) -> None:
    if missing("oci"):
        pytest.skip(missing("oci"))
    submission = submit("plain")

    async def start(image: str) -> None:
        launch = Launch(submission.folder, "agent:Player", address, "token", tmp_path / "log", LIMITS, image)
        await (await SANDBOXES["oci"].start(launch)).stop()

    missing_image = pytest.raises(SandboxError, match=r"create failed: .*nobody/has-this")
    with listening(tmp_path / "match.sock") as address, missing_image:
        asyncio.run(start("nobody/has-this"))

    ours = f"label={engine.OWNER}={leftovers.owner()}"
    assert engine.call(engine.find_engine(), "ps", "-aq", "--filter", ours).stdout == b""


@pytest.mark.slow
def test_the_service_of_podman_is_not_taken_for_docker(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Podman takes the path of a filter of system calls; Docker's command sends what is in it."""
    if not (shutil.which("podman") and shutil.which("docker")):
        pytest.skip("it takes Podman and Docker's command: install podman and docker.io")
    address = f"unix://{tmp_path}/podman.sock"
    service = subprocess.Popen(["podman", "system", "service", "--time", "0", address])
    try:
        wait_until((tmp_path / "podman.sock").exists)
        monkeypatch.setenv("DOCKER_HOST", address)
        monkeypatch.setenv(engine.CHOICE, "docker")

        with pytest.raises(SandboxError, match=r"docker: its daemon is Podman.*: use podman itself"):
            engine.find_engine()
    finally:
        service.terminate()
        service.wait()

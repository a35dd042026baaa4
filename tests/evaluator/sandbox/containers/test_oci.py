"""Containers: which engine runs them, what keeps their wall clock, and what is said where that cannot be."""

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import Submit
from tests.evaluator.sandbox.sandbox_runs import run_agent, wait_until
from tests.evaluator.small_matches import need

from wildscav_evaluator.sandbox import SANDBOXES, SandboxError
from wildscav_evaluator.sandbox.containers import container_engine as engine
from wildscav_evaluator.sandbox.containers import wall_clock
from wildscav_server import leftovers


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
    need("oci")
    with pytest.raises(SandboxError, match=r"create failed: .*nobody/has-this"):
        run_agent(SANDBOXES["oci"], submit("plain"), tmp_path, image="nobody/has-this")

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


@pytest.fixture
def programs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The only folder in which programs are found: its ``timeout``, ``env`` and init are scripts."""
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(wall_clock, "INIT_PLACES", ())
    wall_clock._find_init.cache_clear()
    for name in ("timeout", "env", "docker-init"):
        script = tmp_path / name
        script.write_text("#!/bin/sh\n")
        script.chmod(0o755)
    yield tmp_path
    wall_clock._find_init.cache_clear()


@pytest.mark.parametrize("has_ldd", [True, False])
def test_a_timeout_without_a_loader_is_named(programs: Path, has_ldd: bool) -> None:
    if has_ldd:
        (programs / "ldd").symlink_to("/usr/bin/ldd")

    with pytest.raises(SandboxError, match=f"ldd finds no loader for {programs}/timeout"):
        wall_clock.guarded(["agent"], 60.0)


@pytest.mark.parametrize(
    ("name", "says"), [("timeout", "coreutils"), ("env", "coreutils"), ("docker-init", "package tini")]
)
def test_a_missing_program_is_named_with_its_package(programs: Path, name: str, says: str) -> None:
    (programs / name).unlink()

    with pytest.raises(SandboxError, match=f"there is no .*{says}"):
        wall_clock.guard_files()

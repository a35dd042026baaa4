"""What keeps the wall clock of a container of Docker, and what is said where it cannot be kept."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from wildscav_evaluator.sandbox.base import SandboxError
from wildscav_evaluator.sandbox.containers import wall_clock


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

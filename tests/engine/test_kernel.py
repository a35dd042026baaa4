"""Compiled code is never older than the sources it came from."""

from pathlib import Path

import pytest

import wildscav_engine
from wildscav_engine import kernel

ENGINE = Path(wildscav_engine.__file__).parent


def test_a_kernel_depends_on_files_it_imports_through_others() -> None:
    closure = {path.relative_to(ENGINE).as_posix() for path in kernel._closure(ENGINE / "step.py")}
    assert {"step.py", "systems/motion.py", "geometry/sweep.py", "body.py", "rules.py"} <= closure
    assert "view/__init__.py" not in closure


def test_an_edited_constant_changes_the_digest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "wildscav_engine"
    package.mkdir()
    (package / "body.py").write_text("GRAVITY = 9.81\n")
    (package / "motion.py").write_text("from wildscav_engine.body import GRAVITY\n")
    monkeypatch.setattr(kernel, "PACKAGE", package)
    before = kernel.sources_digest(package / "motion.py")
    (package / "body.py").write_text("GRAVITY = 1.62\n")
    kernel._imported_files.cache_clear()
    assert kernel.sources_digest(package / "motion.py") != before


def test_without_a_writable_cache_a_temporary_one_serves(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", "/dev/null/nowhere")
    assert kernel.cache_folder.__wrapped__(ENGINE / "digest.py").exists()

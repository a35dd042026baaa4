"""Where compiled code is kept."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from wildscav_engine.compilation.caching import cache_folders as folders
from wildscav_engine.compilation.caching.cache_root import cache_root
from wildscav_engine.compilation.caching.sources import PACKAGE, sources_digest


def test_a_folder_is_named_after_the_digest_of_the_sources(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path))
    file = PACKAGE / "simulation/digest.py"
    folder = folders.cache_folder.__wrapped__(file)
    assert folder == tmp_path / "kernels" / sources_digest(file)
    assert folder.is_dir()


def test_without_a_writable_cache_a_temporary_one_serves(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", "/dev/null/nowhere")
    assert folders.cache_folder.__wrapped__(PACKAGE / "simulation/digest.py").exists()


@pytest.mark.parametrize("variable", ["WILDSCAV_CACHE_DIR", "XDG_CACHE_HOME", None])
def test_a_user_without_a_home_needs_none(
    variable: str | None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def nobody(_: int) -> None:
        raise KeyError

    monkeypatch.setattr("pwd.getpwuid", nobody)
    for name in ("HOME", "WILDSCAV_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    if variable is not None:
        monkeypatch.setenv(variable, str(tmp_path))
        assert cache_root().is_relative_to(tmp_path)
    assert folders.cache_folder.__wrapped__(PACKAGE / "simulation/digest.py").is_dir()


def test_the_temporary_one_is_gone_with_its_process(tmp_path: Path) -> None:
    code = (
        "from wildscav_engine.compilation.caching.cache_folders import cache_folder\n"
        "from wildscav_engine.compilation.caching.sources import PACKAGE\n"
        "print(cache_folder(PACKAGE / 'simulation/digest.py').is_dir())"
    )
    environment = {**os.environ, "WILDSCAV_CACHE_DIR": "/dev/null/nowhere", "TMPDIR": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)
    assert done.stdout == "True\n", done.stderr
    assert list(tmp_path.iterdir()) == []


def test_the_longest_unused_folders_go(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(folders, "KEPT_FOLDERS", 2)
    files = [PACKAGE / name for name in ("specs/body.py", "specs/rules.py", "simulation/state.py")]
    kept = [folders.cache_folder.__wrapped__(file) for file in files]
    assert [folder.exists() for folder in kept] == [False, True, True]

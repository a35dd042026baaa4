"""Commands that only ask a season start at once: they load neither a compiler nor statistics."""

import os
import subprocess
import sys
from pathlib import Path

HEAVY = {"numba", "scipy", "grpc", "openskill", "sqlalchemy"}
CODE = """
import sys
from wildscav.cli.main import main
for arguments in {commands!r}:
    sys.argv = ["wildscav", *arguments]
    try:
        main()
    except SystemExit as end:
        assert end.code in (0, 1, 2), arguments
print(*sys.modules)
"""


def loaded_by(home: Path, *commands: list[str]) -> set[str]:
    """Return the modules that a process has loaded that ran some commands."""
    done = subprocess.run(
        [sys.executable, "-c", CODE.format(commands=commands)],
        env={**os.environ, "HOME": str(home), "XDG_CONFIG_HOME": str(home)},
        capture_output=True,
        text=True,
        cwd=home,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return set(done.stdout.splitlines()[-1].split())


def test_competitors_commands_load_nothing_heavy(tmp_path: Path) -> None:
    silent = "http://127.0.0.1:9"
    commands = (["login", silent], ["submissions"], ["matches", "3"], ["logs", "3"], ["team", "show"])
    assert not loaded_by(tmp_path, *commands, ["submit", "nowhere"], ["login", "--logout"]) & HEAVY


def test_no_command_loads_a_compiler_before_it_plays(tmp_path: Path) -> None:
    assert "numba" not in loaded_by(tmp_path, ["season", "init", "spring"], ["audit", "http://127.0.0.1:9"])

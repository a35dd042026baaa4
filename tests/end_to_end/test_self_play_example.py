"""The example of self-play learns: after a few iterations, the policy beats its first self."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "self_play.py"


@pytest.mark.slow
def test_a_few_iterations_beat_the_first_self(tmp_path: Path) -> None:
    command = [sys.executable, str(EXAMPLE), "--iterations", "8", "--matches", "48", "--every", "4"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rows = re.findall(r"^ +(\d+) +(\d+)% +(\d+)% +(\d+)%$", done.stdout, re.MULTILINE)
    assert [int(row[0]) for row in rows] == [0, 4, 8]
    assert int(rows[0][3]) == 50  # against itself
    assert int(rows[-1][3]) > 80
    members = re.findall(r"^(\S+) +(\d+) +(0\.\d\d)$", done.stdout, re.MULTILINE)
    assert [name for name, _, _ in members] == ["self-1", "self-2", "self-3", "walker", "fighter-easy"]
    assert sum(int(games) for _, games, _ in members) == 8 * 48 * 3

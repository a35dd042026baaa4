# ruff: noqa: INP001 - a script, not part of a package
"""Make standings.png, the picture in docs/tournaments.md: the standings of a tournament on battle.

    python docs/images/standings.py

plays 100 matches, which takes a few minutes.
"""

import subprocess
import sys
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory

PICTURE = Path(__file__).with_name("standings.png")
ENTRANTS = (
    *("homing", "hunter", "random"),
    *("robot:walker", "robot:gatherer-easy", "robot:gatherer", "robot:gatherer-hard"),
    *("robot:fighter-easy", "robot:fighter", "robot:fighter-hard"),
)


def main() -> None:
    """Play the tournament, and copy its picture."""
    wildscav = Path(sys.executable).with_name("wildscav")
    with TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        options = "--track=battle", "--rounds=10", "--replays=none", f"--out={out}"
        subprocess.run([wildscav, "tournament", *ENTRANTS, *options], check=True)
        copyfile(out / "standings.png", PICTURE)


if __name__ == "__main__":
    main()

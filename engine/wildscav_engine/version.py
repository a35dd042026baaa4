"""The versions of the engine and of what it simulates."""

import re
import shlex
from importlib.metadata import version
from pathlib import Path

ENGINE_VERSION = version("wildscav")

# Rises whenever the same spec and actions give another match: a record can be played again by its own only.
SIMULATION_VERSION = 5

CHECKOUT = Path(__file__).parents[2]
# Files name the version that made them, and what is printed here is copied into shells.
RELEASE = re.compile(r"\d+(\.\d+){0,3}((a|b|rc)\d+)?", re.ASCII)


def advice(made_by: str) -> str:
    """Return what to do with a record that another version made and this one cannot play."""
    if not RELEASE.fullmatch(made_by):
        return f"play it with the engine that made it ({made_by})"
    if made_by == ENGINE_VERSION:
        return f"play it with the engine that made it ({made_by}, at another commit)"
    line = f"pip install 'wildscav[evaluator]=={made_by}'"
    if (CHECKOUT / ".git").exists():
        folder = CHECKOUT.parent / f"wildscav-{made_by}"
        fetch = shlex.join(["git", "-C", str(CHECKOUT), "worktree", "add", str(folder), made_by])
        line = f"{fetch} && pip install {shlex.quote(f'{folder}[evaluator]')}"
    return f"play it with release {made_by}, which made it, in an environment of its own: {line}"

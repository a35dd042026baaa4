"""The list of modules: what the first line of each docstring says, folder by folder.

``make docs`` makes the page; in the repository, each module begins with its line.
"""

import re
from collections.abc import Iterator
from pathlib import Path

from wildscav_website.links import ROOT
from wildscav_website.markdown import code, prose, sentence, table

DOCSTRING = re.compile(r'(?:#.*\n|\s)*"""(.*?)(?:"""|\n)')  # a module's, to the end of its first line
HEAD = """---
search: { exclude: true }
---

# Every module

This page is generated from the first lines of the modules' docstrings.
[How Wildscav is built](../architecture.md) explains how they work together.
"""


def page() -> str:
    """Return the page."""
    homes = [ROOT / "engine" / "wildscav_engine", *sorted((ROOT / "platform").glob("wildscav*"))]
    homes += [ROOT / "evaluator" / "wildscav_evaluator", ROOT / "leaderboard" / "wildscav_leaderboard"]
    return "\n".join([HEAD, *(line for home in homes for line in _package(home, 2))])


def _package(folder: Path, level: int) -> Iterator[str]:
    """Describe a package, its modules, and the packages in it."""
    if not (folder / "__init__.py").is_file():
        return
    yield f"{'#' * level} {folder.relative_to(ROOT).as_posix()}\n"
    yield f"{sentence(_first_line(folder / '__init__.py'))}\n"
    modules = [path for path in sorted(folder.glob("[a-z]*.py")) if not path.stem.endswith("_pb2")]
    yield table(("module", "what is in it"), ((code(path.name), _first_line(path)) for path in modules))
    for below in sorted(path for path in folder.iterdir() if path.is_dir()):
        yield from _package(below, 3)


def _first_line(path: Path) -> str:
    found = DOCSTRING.match(path.read_text("utf-8"))
    return prose(found[1]).replace("<", "&lt;") if found else ""

"""The names that others build on: those in public_names.json, and those that there are.

``python -m tests.releases.public_names``, in the root of the repository, writes those that there are.
"""

import ast
import importlib
import json
from importlib.metadata import entry_points
from pathlib import Path

import gymnasium

import wildscav_engine.envs  # noqa: F401 - registers the environments
from wildscav.proto import match_pb2

ROOT = Path(__file__).parents[2]
FILE = Path(__file__).with_name("public_names.json")
COMMAND = "python -m tests.releases.public_names"
HARNESS = sorted(file.stem for file in (ROOT / "platform/wildscav/harness").glob("[!_]*.py"))
# Without a list of their own.
MODULES = ("wildscav.words", "wildscav.keyboard", *(f"wildscav.harness.{name}" for name in HARNESS))
PARTS = ("engine", "platform", "evaluator", "leaderboard")


def names_now() -> dict[str, list[str]]:
    """Return the public names of packages and of the protocol, and what Gymnasium and the command know."""
    files = [file for part in PARTS for file in (ROOT / part).rglob("__init__.py")]
    listed = {".".join(file.parent.relative_to(ROOT).parts[1:]): _listed_in(file) for file in sorted(files)}
    return {
        **{package: names for package, names in sorted(listed.items()) if names},
        **{module: _defined_in(module) for module in MODULES},
        "environments": sorted(name for name in gymnasium.registry if name.startswith("WildScav/")),
        "commands": sorted(point.name for point in entry_points(group="wildscav.commands")),
        "protocol": sorted(
            f"{message}.{field.name} = {field.number}"
            for message, described in match_pb2.DESCRIPTOR.message_types_by_name.items()
            for field in described.fields
        ),
    }


def _listed_in(file: Path) -> list[str]:
    """Return what a file has in ``__all__``, also what it has only with optional libraries."""
    assigned = (ast.Assign, ast.AugAssign)
    lists = [
        statement.value
        for statement in ast.walk(ast.parse(file.read_text("utf-8")))
        if isinstance(statement, assigned) and ast.unparse(statement).startswith("__all__ ")
    ]
    return sorted(node.value for value in lists for node in ast.walk(value) if isinstance(node, ast.Constant))


def _defined_in(module: str) -> list[str]:
    """Return the public classes and functions that a module defines."""
    things = vars(importlib.import_module(module)).items()
    return sorted(
        name for name, thing in things if name[0] != "_" and getattr(thing, "__module__", "") == module
    )


if __name__ == "__main__":
    FILE.write_text(json.dumps(names_now(), indent=1) + "\n", "utf-8")

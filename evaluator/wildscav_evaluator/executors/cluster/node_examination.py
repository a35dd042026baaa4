"""What a node tells about itself before it gets work. This runs on the node, with the node's own Wildscav."""

from collections.abc import Sequence
from functools import cache
from hashlib import blake2b
from pathlib import Path
from typing import Any

import wildscav
import wildscav_engine
import wildscav_evaluator
from wildscav.errors import WildscavError
from wildscav_evaluator.output.results import CURRENT_VERSIONS
from wildscav_evaluator.sandbox import DEFAULT_LIMITS, SANDBOXES
from wildscav_evaluator.sandbox.choose import missing_promises
from wildscav_evaluator.submissions.images import image_problem
from wildscav_server import leftovers

PACKAGES = (wildscav, wildscav_engine, wildscav_evaluator)


@cache
def code_digest() -> str:
    """Return a digest of the code of Wildscav that is installed here, 16 hexadecimal digits."""
    digest = blake2b(digest_size=8)
    for package in PACKAGES:
        root = Path(str(package.__file__)).parent
        for path in sorted(root.rglob("*.py")):
            digest.update(f"{path.relative_to(root).as_posix()}\0".encode() + path.read_bytes())
    return digest.hexdigest()


def examine(sandboxes: Sequence[str], images: Sequence[str]) -> dict[str, Any]:
    """Return this node's versions, the broken promises of sandboxes, and the problems of images.

    Everything in the result is of plain types, because another version of Wildscav may read it.
    """
    leftovers.sweep()
    return {
        "versions": CURRENT_VERSIONS.model_dump(),
        "code": code_digest(),
        "sandboxes": {name: _broken(name) for name in sandboxes},
        "images": {name: image_problem(name) for name in images},
    }


def _broken(sandbox: str) -> str:
    if sandbox not in SANDBOXES:
        return f"there is no sandbox {sandbox} there"
    try:
        return missing_promises(SANDBOXES[sandbox], DEFAULT_LIMITS)
    except (WildscavError, OSError) as error:
        return str(error)


def mismatch(examination: dict[str, Any]) -> str:
    """Return in one line how a node's Wildscav differs from the one here; an empty text if it does not."""
    here = CURRENT_VERSIONS.model_dump()
    there = examination["versions"]
    differing = [name for name in here if there.get(name) != here[name]]
    if differing:
        versions = ", ".join(f"{name} {there.get(name)} instead of {here[name]}" for name in differing)
        return f"it has another version of Wildscav: {versions}"
    if examination["code"] != code_digest():
        return "its Wildscav has the same version, but other code: install the same files there"
    return ""

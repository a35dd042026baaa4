"""What a submission's folder says about its agent: the manifest, the entry point, and the class behind it."""

import importlib
import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from wildscav.errors import UserError

MANIFEST = "submission.toml"
USAGE, AGENT_FAILED = 2, 3  # exit codes


def read_manifest(path: Path) -> dict[str, Any]:
    """Return the content of a manifest, whose fields are not checked.

    Raises:
        UserError: It cannot be read, or is not valid TOML.
    """
    try:
        return tomllib.loads(path.read_text("utf-8"))
    except OSError as error:
        raise UserError(f"cannot read {path}: {error.strerror}", USAGE) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UserError(f"{path} is not valid TOML: {error}", USAGE) from None


def entry_point_of(manifest: Mapping[str, Any]) -> str:
    """Return the entry point in a manifest, or raise a UserError if there is none."""
    entry_point = manifest.get("entry_point")
    if not isinstance(entry_point, str):
        raise UserError("submission.toml has neither an entry_point nor a command", USAGE)
    return entry_point


def load_agent_class(entry_point: str) -> Callable[[], Any]:
    """Import the agent's class. Exceptions of its module are passed on.

    Raises:
        UserError: The entry point is not of the form MODULE:CLASS, or the module has no such class.
    """
    module_name, _, class_name = entry_point.partition(":")
    if not module_name or not class_name:
        raise UserError(f"entry point is {entry_point!r}, must be MODULE:CLASS, such as agent:MyAgent", USAGE)
    module = importlib.import_module(module_name)
    factory: object = getattr(module, class_name, None)
    if not callable(factory):
        raise UserError(f"module {module_name} ({module.__file__}) has no class {class_name}", AGENT_FAILED)
    return factory

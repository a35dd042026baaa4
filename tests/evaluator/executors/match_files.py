"""The files that matches leave."""

import json
from pathlib import Path


def contents(out: Path) -> dict[str, object]:
    """Return the contents of all files by name, without how long anything took."""
    found: dict[str, object] = {}
    for path in sorted(out.rglob("*.*")):
        content = path.read_bytes()
        found[str(path.relative_to(out))] = content
        if path.suffix == ".json":
            entry = json.loads(content)
            del entry["timing"]
            found[str(path.relative_to(out))] = entry
    return found

"""The files that matches leave."""

from pathlib import Path


def contents(out: Path) -> dict[str, bytes]:
    """Return the contents of all files by their paths in a folder."""
    return {
        str(path.relative_to(out)): path.read_bytes() for path in sorted(out.rglob("*.*")) if path.is_file()
    }

"""Changing what is published, as an organizer who cheats would: with sums that fit."""

import hashlib
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from wildscav_leaderboard.publishing.export import SUMS_FILE


class Published:
    """An exported season in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __str__(self) -> str:
        return str(self.folder)

    def lines(self, track: str) -> list[dict[str, Any]]:
        """Everything in a track's file."""
        text = (self.folder / f"tracks/{track}.ndjson").read_text("utf-8")
        return [json.loads(line) for line in text.splitlines()]

    def board(self, track: str) -> dict[str, Any]:
        """The published board of a track."""
        return self.lines(track)[0]["board"]  # type: ignore[no-any-return]

    def change_lines(self, track: str, change: Callable[[list[dict[str, Any]]], object]) -> None:
        """Change the file of a track."""
        lines = self.lines(track)
        change(lines)
        text = "".join(f"{json.dumps(line)}\n" for line in lines)
        (self.folder / f"tracks/{track}.ndjson").write_text(text, "utf-8")
        self.resum()

    def _change(self, file: str, change: Callable[[dict[str, Any]], object]) -> None:
        path = self.folder / file
        document = json.loads(path.read_text("utf-8"))
        change(document)
        path.write_text(json.dumps(document), "utf-8")
        self.resum()

    def change_shown(self, track: str, change: Callable[[dict[str, Any]], object]) -> None:
        """Change a board where it is shown."""
        self._change(f"boards/{track}.json", change)

    def change_board(self, track: str, change: Callable[[dict[str, Any]], object]) -> None:
        """Change a board wherever it is published."""
        self.change_lines(track, lambda lines: change(lines[0]["board"]))
        self.change_shown(track, change)

    def change_matches(self, track: str, change: Callable[[list[dict[str, Any]]], object]) -> None:
        """Change the matches of a track."""

        def change_among(lines: list[dict[str, Any]]) -> None:
            matches = [line["match"] for line in lines if "match" in line]
            change(matches)
            others = [line for line in lines[:-1] if "match" not in line]
            end = {"end": {**lines[-1]["end"], "matches": len(matches)}}
            lines[:] = [*others, *({"match": match} for match in matches), end]

        self.change_lines(track, change_among)

    def change_season(self, change: Callable[[dict[str, Any]], object]) -> None:
        """Change the season's document."""
        self._change("season.json", change)

    def record(self, match: int) -> Path:
        """The path of a match's record."""
        return self.folder / "records" / "0000" / f"{match}.wsr"

    def matches(self, track: str) -> list[dict[str, Any]]:
        """The matches of a track."""
        return [line["match"] for line in self.lines(track) if "match" in line]

    def resum(self) -> None:
        """Write sums that fit to the files."""
        files = sorted(path for path in self.folder.rglob("*") if path.is_file() and path.name != SUMS_FILE)
        self.folder.joinpath(SUMS_FILE).write_text(
            "".join(
                f"{hashlib.sha256(path.read_bytes()).hexdigest()}  "
                f"{path.relative_to(self.folder).as_posix()}\n"
                for path in files
            )
        )


def numbers(document: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the path of every number in a document."""
    if isinstance(document, dict):
        for name, value in document.items():
            yield from numbers(value, (*path, name))
    elif isinstance(document, list):
        for index, value in enumerate(document):
            yield from numbers(value, (*path, index))
    elif isinstance(document, int | float) and not isinstance(document, bool):
        yield path


def replace_at(document: Any, path: tuple[Any, ...], change: Callable[[Any], Any]) -> None:
    """Replace the value at a path."""
    for name in path[:-1]:
        document = document[name]
    document[path[-1]] = change(document[path[-1]])

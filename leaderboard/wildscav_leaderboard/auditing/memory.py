"""What earlier audits of the same season saw: what was published once never changes.

A result, the submission that it belongs to, its record and its place in the ladder's order stay as they are
from the moment they are published. So whoever audits a season from time to time notices if its past moves,
even before its secrets are opened.
"""

import json
from collections.abc import Iterator
from hashlib import blake2b
from pathlib import Path

from wildscav_engine.storage.files import read_limited, write_whole
from wildscav_leaderboard.auditing.report import Check, Finding, of_match
from wildscav_leaderboard.publishing.documents import (
    BoardFile,
    PublishedBoard,
    PublishedMatch,
    PublishedSeason,
)

LARGEST = 256 << 20  # bytes


class Memory:
    """What was seen of one season. A file in the cache; if it is lost, the next audit is the first one again.

    Args:
        folder: Where the memories of all seasons are.
        address: Of the season's document.
        season: That document. A season of another name, or that opens at another time, is another one.
    """

    def __init__(self, folder: Path, address: str, season: PublishedSeason) -> None:
        name = f"{address}\n{season.name}\n{season.opens}"
        self._path = folder / f"{blake2b(name.encode(), digest_size=16).hexdigest()}.json"
        self._before: dict[str, str] = {}
        self._new: dict[str, str] = {}
        try:
            content = json.loads(read_limited(self._path, LARGEST))
            self._before = {str(name): str(digest) for name, digest in content.items()}
        except (OSError, ValueError, AttributeError):
            return

    def changed_season(self, season: PublishedSeason) -> Iterator[Finding]:
        """Yield which commitments are no longer those that were published before."""
        for name, one in (("secret", season.secret), ("final_secret", season.final_secret)):
            if self._was(name, one.commitment) != one.commitment:
                secret = name.replace("_", " ")
                yield Finding(
                    f"the commitment to the {secret} was {self._before[name]} at an earlier audit",
                    field=f"{name}.commitment",
                    published=one.commitment,
                    expected=self._before[name],
                )

    def changed_matches(self, board: PublishedBoard, file: BoardFile, check: Check) -> Iterator[Finding]:
        """Yield which matches of a board are no longer as they were published before."""
        for match in file.matches:
            named = _digests_of(f"{board.track}/{match.id}", match)
            check.checked += any(name in self._before for name in named)
            if any(self._new.get(name, digest) != digest for name, digest in named.items()):
                yield Finding("another board of the track counts it differently", **of_match(match, file))
            changed = [name for name, digest in named.items() if self._was(name, digest) != digest]
            if changed:
                yield Finding(
                    "it is no longer what was published of it at an earlier audit", **of_match(match, file)
                )

    def keep(self) -> None:
        """Remember what is new. A cache that cannot be written is no reason to fail."""
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(self._path, json.dumps({**self._new, **self._before}).encode())
        except OSError:
            return

    def _was(self, name: str, value: str) -> str:
        """Note how something is now, and return how it was when it was first seen."""
        self._new.setdefault(name, value)
        return self._before.get(name, value)


def _digests_of(name: str, match: PublishedMatch) -> dict[str, str]:
    """Return digests of what must not change about a match, by name: whose record it is, and its result.

    The result has none while it is hidden. Whether the record is still hidden may change.
    """
    whose = match.model_dump_json(include={"id", "kind", "number", "submission", "record"})
    contents = {f"{name}/record": whose}
    if not match.withheld:
        contents[name] = match.model_dump_json(exclude={"hidden", "superseded"})
    return {one: blake2b(text.encode(), digest_size=8).hexdigest() for one, text in contents.items()}

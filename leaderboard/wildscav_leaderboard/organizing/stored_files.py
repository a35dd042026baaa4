"""The files that a season's database refers to: the archives of submissions, and the records of matches."""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from sqlalchemy import select
from sqlalchemy.orm import Session

from wildscav.errors import describe
from wildscav_leaderboard.matches.models import MatchResult
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions.models import Submission

PIECE = 1 << 20  # bytes


@dataclass(frozen=True)
class StoredFile:
    """A file as the database describes it."""

    path: Path
    what: str  # such as "the record of match 7"
    digest: str  # SHA-256 of an archive, BLAKE2b of 16 bytes of a record
    size: int  # bytes

    def problem(self) -> str:
        """Return what is wrong with the file; an empty text if nothing is."""
        sha256, blake2b = hashlib.sha256(), hashlib.blake2b(digest_size=16)
        total = sha256 if len(self.digest) == 2 * sha256.digest_size else blake2b
        try:
            size = self.path.stat().st_size
            if size != self.size:
                return f"{self.what} has {size:,} bytes, must have {self.size:,}: {self.path}"
            with self.path.open("rb") as file:
                while piece := file.read(PIECE):
                    total.update(piece)
        except FileNotFoundError:
            return f"{self.what} is missing: {self.path}"
        except OSError as error:
            return f"{self.what} cannot be read: {describe(error)}"
        return "" if total.hexdigest() == self.digest else f"{self.what} was changed: {self.path}"


def stored_files(session: Session, season: Season) -> Iterator[StoredFile]:
    """Yield the archive of every submission, and the record of every result."""
    archives = select(Submission.archive, Submission.id, Submission.size).order_by(Submission.id)
    seen = set()
    for name, number, size in session.execute(archives):
        if name not in seen:
            seen.add(name)
            what = f"the archive of submission {number}"
            yield StoredFile(season.archives / name, what, name.partition(".")[0], size)
    results = select(
        MatchResult.match_id, MatchResult.row["record"], MatchResult.record, MatchResult.record_size
    )
    for number, record, digest, size in session.execute(results.order_by(MatchResult.match_id)):
        path = season.match_folder(number) / str(record)
        yield StoredFile(path, f"the record of match {number}", digest, size)

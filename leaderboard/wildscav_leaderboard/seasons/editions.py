"""Editions: the rules under which a track is played, each immutable and known by its digest.

Everything that decides whether two results can be compared belongs to an edition. A match is planned, played
and counted under one edition. A change of the settings, of the engine or of the sandbox makes another
edition, which comes into force only when the organizers apply it (``conductor/editions.py``).
"""

import hashlib
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wildscav_evaluator.output.json_files import FileModel, WithOptionalFields
from wildscav_evaluator.output.results import CURRENT_VERSIONS, KeptLimits, MetricInfo, ModelTerms, Versions
from wildscav_leaderboard.seasons.settings import Mode, TrackSettings

if TYPE_CHECKING:
    from wildscav_evaluator.suites.suite import Suite


class Part(FileModel):
    """A part of a document, which never changes once it is made."""


class Conditions(Part, WithOptionalFields):
    """What results depend on besides the submissions. Only results with equal conditions share a board."""

    omitted = ("model",)

    versions: Versions
    suite: str
    suite_digest: str | None = None  # SHA-256 of the file of an organizer's own suite
    mode: Mode = "suite"
    rounds: int
    seats: int = 1  # entrants in a match
    robots: tuple[str, ...] = ()  # that take part as entrants
    commitment: str  # SHA-256 of the secret from which the matches follow
    sandbox: str
    limits: KeptLimits
    model: ModelTerms | None = None  # that submissions may ask; omitted if there is none


def digest_of(conditions: Conditions) -> str:
    """Return a digest of conditions, 32 hexadecimal digits; equal conditions have equal ones."""
    return blake2b(conditions.model_dump_json().encode(), digest_size=16).hexdigest()


class Edition(Part):
    """The rules of a track, and what follows from them."""

    settings: TrackSettings  # those that ``DECIDING`` does not name may change within an edition
    suite_file: str | None  # the file of an organizer's own suite
    conditions: Conditions
    final_commitment: str  # to the secret of the matches that decide the season
    matches: int  # of the suite, in all rounds
    metrics: tuple[MetricInfo, ...]  # the first is the score

    @property
    def final(self) -> Conditions:
        """The conditions of the matches that decide the season."""
        return self.conditions.model_copy(update={"commitment": self.final_commitment})

    def suite(self) -> "Suite":
        """Return its suite.

        Raises:
            UserError: It is not installed here.
        """
        from wildscav_evaluator.suites.suite_file import find_suite, parse_suite

        if self.suite_file is None:
            return find_suite(self.settings.suite)
        return parse_suite(Path(self.settings.suite), self.suite_file.encode())

    def obstacle(self, sandbox: str, model: ModelTerms | None) -> str:
        """Return why its matches cannot be played here and now; an empty text if they can."""
        made, now = self.conditions.versions, CURRENT_VERSIONS
        if made != now:
            return f"they belong to {made}, and this is {now}"
        if self.conditions.sandbox != sandbox:
            return f"they belong to the sandbox {self.conditions.sandbox}, and this is {sandbox}"
        if self.conditions.model != model:
            return (
                f"they belong to the model {self.conditions.model or 'none'}, and the settings name another"
            )
        if self.suite_file is None and self.suite().label != self.conditions.suite:
            return f"they belong to the suite {self.conditions.suite}, which is not installed here"
        return ""


# Settings of a track that belong to its edition.
DECIDING = ("mode", "suite", "rounds", "wall_clock", "seats", "robots")


def changes_between(track: str, before: Edition, after: Edition) -> list[str]:
    """Return in what an edition differs from another one, in words.

    What a suite's file says of other tracks, or in comments, is no difference.
    """
    old, new = before.conditions.model_dump(mode="json"), after.conditions.model_dump(mode="json")
    del new["suite_digest"]
    files = before.suite_file, after.suite_file
    if None not in files and len({one.suite().fingerprints[track] for one in (before, after)}) == 1:
        del new["suite"]
    names = [name for name in new | old if name in new or name == "model"]
    return [
        f"{name} {_shown(old.get(name))} → {_shown(new.get(name))}"
        for name in names
        if old.get(name) != new.get(name)
    ]


def _shown(value: Any) -> str:
    if isinstance(value, dict):
        return " ".join(f"{name} {one}" for name, one in value.items() if one is not None)
    if isinstance(value, list):
        return ", ".join(value) or "none"
    return str(value)[:16]


def sha256_of(source: bytes | None) -> str | None:
    """Return the SHA-256 of the file of an organizer's own suite; None if the suite has none."""
    return None if source is None else hashlib.sha256(source).hexdigest()

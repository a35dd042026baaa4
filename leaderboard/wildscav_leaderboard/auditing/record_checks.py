"""Checking the records of a season's matches: all of them, or some that are chosen by chance."""

import random
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

from wildscav_evaluator.executors import Executor
from wildscav_leaderboard.auditing.records import Fetched, Recorded, Task, check_record
from wildscav_leaderboard.auditing.report import Finding, Report, of_match
from wildscav_leaderboard.boards.documents import BoardDocument
from wildscav_leaderboard.publishing.documents import BoardFile, PublishedBoard, PublishedMatch

AT_ONCE = 4  # downloads
NOT_ASKED = "nobody asked for it (--download, --resimulate)"
NOT_KNOWN = "their records are not known here"

OnProgress = Callable[[str, int, int], None]  # what is done, how many are, of how many


@dataclass(frozen=True)
class Wanted:
    """What an audit is to check."""

    track: str | None = None  # None: all
    records: int | None = None  # how many of each board, chosen at random; None: all
    replay: int | None = None  # how many of those are played again; None: all
    commitment: str | None = None  # that was noted earlier


@dataclass
class RecordChecks:
    """Checks records, each once, however many boards count its match."""

    wanted: Wanted  # how many
    fetch: Callable[[PublishedMatch], Fetched]  # the record of a match; several threads call it
    executor: Executor  # where records are played again
    on_progress: OnProgress
    known: dict[str, Recorded] = field(default_factory=dict)  # by what is published of the match

    def check(
        self, report: Report, published: PublishedBoard, file: BoardFile, board: BoardDocument
    ) -> dict[int, Recorded]:
        """Check the records of a board's matches; return what they say, by match."""
        records = report.check("records", published.label)
        replays = report.check("records played again", published.label)
        played = [match for match in file.matches if match.void is None and match.record is not None]
        visible = [match for match in played if match.hidden is None]
        for match in played:
            if match.hidden is not None:
                records.skip(match.hidden)
        chosen = _some(visible, self.wanted.records)
        again = {match.id for match in _some(chosen, self.wanted.replay)}
        records.skip(NOT_ASKED, len(visible) - len(chosen))
        replays.skip(NOT_KNOWN, len(played) - len(chosen))
        replays.skip(NOT_ASKED, len(chosen) - len(again))
        found: dict[int, Recorded] = {}
        for match, one in self._checked(chosen, again, published, board):
            found[match.id] = one
            self.on_progress(f"checking records of {published.label}", len(found), len(chosen))
            records.checked += 1
            replays.checked += one.replayed
            if one.unplayed:
                replays.skip(one.unplayed)
            place = of_match(match, file)
            report.findings += [Finding(fault, **place) for fault in one.faults]
        return found

    def _checked(
        self,
        matches: Sequence[PublishedMatch],
        again: set[int],
        published: PublishedBoard,
        board: BoardDocument,
    ) -> Iterator[tuple[PublishedMatch, Recorded]]:
        """Yield what the records of some matches say, in any order."""
        versions = board.conditions.versions

        def key(match: PublishedMatch) -> str:
            return f"{published.track} {match.id in again} {versions} {match.model_dump_json()}"

        new = []
        for match in matches:
            if key(match) in self.known:
                yield match, self.known[key(match)]
            else:
                new.append(match)
        by_id = {match.id: match for match in new}
        with ThreadPoolExecutor(AT_ONCE) as pool:

            def tasks() -> Iterator[Task]:
                for fetched in _ahead(pool, self.fetch, new):
                    yield Task(fetched, published.track, versions, fetched.match.id in again)

            for one in self.executor.map(check_record, tasks()):
                match = by_id[one.match]
                self.known[key(match)] = one
                yield match, one


def _some(matches: Sequence[PublishedMatch], count: int | None) -> list[PublishedMatch]:
    """Return some matches, chosen so that nobody can know them beforehand."""
    if count is None or count >= len(matches):
        return list(matches)
    return sorted(random.SystemRandom().sample(list(matches), count), key=lambda match: match.id)


def _ahead(
    pool: ThreadPoolExecutor, fetch: Callable[[PublishedMatch], Fetched], matches: Sequence[PublishedMatch]
) -> Iterator[Fetched]:
    """Yield records in order, with a few being downloaded ahead."""
    waiting = []
    for match in matches:
        waiting.append(pool.submit(fetch, match))
        if len(waiting) >= 2 * AT_ONCE:
            yield waiting.pop(0).result()
    for one in waiting:
        yield one.result()

"""The audit of a season: everything that is published is recomputed, and compared digit for digit."""

from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from wildscav.errors import UserError
from wildscav_evaluator.executors import Executor
from wildscav_evaluator.output.results import mean_metrics
from wildscav_evaluator.suites.seeds import SuiteSeed, seed_of
from wildscav_leaderboard.auditing.boards import computed_board, differences, wrong_conditions, wrong_counts
from wildscav_leaderboard.auditing.drawn_matches import (
    UnknownSuiteError,
    suite_of,
    wrong_draws,
    wrong_games,
    wrong_suite,
)
from wildscav_leaderboard.auditing.matches import wrong_matches
from wildscav_leaderboard.auditing.memory import Memory
from wildscav_leaderboard.auditing.opening import (
    InvalidDocumentError,
    open_source,
    read_lines,
    read_shown,
    wrong_sums,
)
from wildscav_leaderboard.auditing.record_checks import NOT_KNOWN, OnProgress, RecordChecks, Wanted
from wildscav_leaderboard.auditing.records import Recorded, fetcher
from wildscav_leaderboard.auditing.report import Check, Finding, Report, of_match, wrong_value
from wildscav_leaderboard.auditing.sources import FolderSource, Source
from wildscav_leaderboard.boards.documents import BoardDocument
from wildscav_leaderboard.publishing.documents import (
    BoardFile,
    PublishedBoard,
    PublishedMatch,
    PublishedSeason,
    PublishedSecret,
    PublishedTrack,
)

TRIES = 3  # at reading a board and its matches of one moment

WRONG_SECRET = "the opened secret is not the one of the commitment"  # noqa: S105
NOT_OPENED = "the secret is not opened yet"

Seeds = dict[str, SuiteSeed | None]  # by commitment; None while the secret is not opened


@dataclass(frozen=True)
class Audit:
    """One audit of a season."""

    wanted: Wanted  # what to check
    executor: Executor  # where records are played again
    cache: Path  # the folder of downloaded records
    on_progress: OnProgress = lambda *_: None  # called with what is being done

    def run(self, place: str) -> Report:
        """Audit what is published in a folder, or at an address.

        Raises:
            UserError: There is nothing to audit there, or it cannot be read.
        """
        with ExitStack() as stack:
            source, season = open_source(place, stack)
            boards = _chosen(season, self.wanted.track)
            commitments = season.secret.commitment, season.final_secret.commitment
            report = Report(season.name, source.name, commitments)
            seeds = self._check_season(report, source, season)
            memory = Memory(self.cache / "seen", source.name, season)
            report.findings += memory.changed_season(season)
            fetch = fetcher(source, season.records, self.cache / "records")
            records = RecordChecks(self.wanted, fetch, self.executor, self.on_progress)
            for track, board in boards:
                before = len(report.findings)
                try:
                    self._check_board(report, source, season, track, board, seeds, records, memory)
                except InvalidDocumentError as error:
                    report.findings.append(Finding(str(error)))
                report.findings[before:] = [
                    replace(one, track=board.label) for one in report.findings[before:]
                ]
            if source.is_live:
                memory.keep()
            return report

    def _check_season(self, report: Report, source: Source, season: PublishedSeason) -> Seeds:
        """Check the season's document; return the seeds that its opened secrets give."""
        if isinstance(source, FolderSource):
            count, findings = wrong_sums(Path(source.name))
            report.check("files and their sums").checked = count
            report.findings += findings
        public = {one.track for one in season.boards if one.audience == "public"}
        report.findings += [
            Finding("its board is not published for audits", track=one.name)
            for one in season.tracks
            if one.name not in public
        ]
        noted = self.wanted.commitment
        known = [season.secret.commitment, season.final_secret.commitment]
        if noted is not None and noted not in known:
            report.findings.append(wrong_value("commitment", " and ".join(known), noted))
        check = report.check("secrets and their commitments")
        return {one.commitment: _opened(report, check, one) for one in (season.secret, season.final_secret)}

    def _check_board(
        self,
        report: Report,
        source: Source,
        season: PublishedSeason,
        track: PublishedTrack,
        published: PublishedBoard,
        seeds: Seeds,
        records: RecordChecks,
        memory: Memory,
    ) -> None:
        self.on_progress(f"reading {published.label}", 0, 0)
        file, shown = _of_one_moment(source, published)
        rows = report.check("rows of the board", published.label)
        counted = report.check("results of matches", published.label)
        board = file.board
        if board is None:
            rows.skip("there are no results yet")
            if shown is not None:
                report.findings.append(Finding("a board is shown, but none is published for audits"))
            return
        if shown != board:
            report.findings += _shown_differently(board, shown)
        report.findings += wrong_conditions(board, track, season)
        secret = season.secret_of(board.conditions.commitment)
        commitment, is_opened = secret.commitment, secret.secret is not None
        is_final = commitment == season.final_secret.commitment
        report.findings += wrong_matches(track, board, file, final=is_final)
        given_up, withheld = "they were given up, and count for nobody", ""
        for match in file.matches:
            withheld = match.withheld or withheld
            if match.void is None and not match.withheld:
                counted.checked += 1
            else:
                counted.skip(match.withheld or given_up)
        report.findings += memory.changed_matches(
            published, file, report.check("results as an earlier audit saw them", published.label)
        )
        recorded = records.check(report, published, file, board)
        report.findings += _wrong_results(file, recorded)
        if withheld:
            rows.skip(withheld, len(board.rows))
            report.findings += wrong_counts(board, file)
            _check_draws(report, track, published, file, recorded, seeds[commitment], is_opened=is_opened)
            return
        self.on_progress(f"computing the board {published.label}", 0, 0)
        matches = [_corrected(match, recorded.get(match.id)) for match in file.matches]
        try:
            computed = computed_board(track, board, file, matches)
        except (ArithmeticError, LookupError, ValueError, ValidationError) as error:
            report.findings.append(Finding(f"no board follows from its matches: {error}"))
            return
        report.findings += differences(board, computed)
        rows.checked = len(board.rows)
        _check_draws(report, track, published, file, recorded, seeds[commitment], is_opened=is_opened)


def _opened(report: Report, check: Check, one: PublishedSecret) -> SuiteSeed | None:
    """Return the seed that an opened secret gives, if it is the one of its commitment."""
    if one.secret is None:
        check.skip(NOT_OPENED)
        return None
    check.checked += 1
    try:
        seed = seed_of(bytes.fromhex(one.secret))
    except ValueError:
        report.findings.append(Finding("a secret is not written in hexadecimal digits", field="secret"))
        return None
    if seed.commitment == one.commitment:
        return seed
    report.findings.append(
        Finding(
            f"an opened secret has the commitment {seed.commitment}, but {one.commitment} was published",
            field="commitment",
            published=one.commitment,
            expected=seed.commitment,
        )
    )
    return None


def _chosen(season: PublishedSeason, track: str | None) -> list[tuple[PublishedTrack, PublishedBoard]]:
    """Return the boards that are to be checked, with what is played on their tracks."""
    tracks = {one.name: one for one in season.tracks}
    if track is not None and track not in tracks:
        raise UserError(f"the season has no track {track!r}; it has {', '.join(tracks)}", exit_code=2)
    return [(tracks[one.track], one) for one in season.boards if track in (None, one.track)]


def _of_one_moment(source: Source, board: PublishedBoard) -> tuple[BoardFile, BoardDocument | None]:
    """Return a board's file, and the board that is shown to everyone, both of the same moment."""
    for attempt in range(TRIES):
        file, shown = read_lines(source, board), read_shown(source, board)
        moments = [None if one is None else one.updated for one in (file.board, shown)]
        if moments[0] == moments[1] or not source.is_live or attempt + 1 == TRIES:
            break
    return file, shown


def _shown_differently(board: BoardDocument, shown: BoardDocument | None) -> Iterator[Finding]:
    if shown is None:
        yield Finding("no board is shown")
    elif shown.mode != board.mode:
        yield wrong_value("mode", shown.mode, board.mode)
    else:
        for one in differences(shown, board):
            yield replace(one, problem=f"{one.problem} (in the board that is shown)")


def _wrong_results(file: BoardFile, recorded: dict[int, Recorded]) -> Iterator[Finding]:
    """Yield the results of matches that are not those of their records."""
    for match in file.matches:
        found = recorded.get(match.id)
        if found is None or found.metrics is None:
            continue
        for seat in match.seats:
            own = found.metrics[seat.seat]
            for name in {**own, **seat.metrics}:
                if own.get(name) != seat.metrics.get(name):
                    place: dict[str, Any] = of_match(match, file)
                    field = f"seats.{seat.seat}.metrics.{name}"
                    yield wrong_value(field, seat.metrics.get(name), own.get(name), **place)


def _corrected(match: PublishedMatch, recorded: Recorded | None) -> PublishedMatch:
    """Return a match with the metrics of its record, if that is known, and with their means."""
    seats = match.seats
    if recorded is not None and recorded.metrics is not None:
        metrics = recorded.metrics
        seats = tuple(seat.model_copy(update={"metrics": metrics[seat.seat]}) for seat in seats)
    if not seats:
        return match
    try:
        mean = mean_metrics([seat.metrics for seat in seats])
    except KeyError:
        return match
    return match.model_copy(update={"seats": seats, "metrics": mean})


def _check_draws(
    report: Report,
    track: PublishedTrack,
    published: PublishedBoard,
    file: BoardFile,
    recorded: dict[int, Recorded],
    seed: SuiteSeed | None,
    *,
    is_opened: bool,
) -> None:
    """Check that the matches are those that the secret gives, as far as it is known."""
    if track.mode == "ladder":
        report.findings += wrong_games(
            file, recorded, report.check("seats of the ladder's games", published.label)
        )
    check: Check = report.check("matches drawn by the secret", published.label)
    known = sum(found.spec is not None for found in recorded.values())
    played = sum(match.void is None for match in file.matches)
    try:
        report.findings += wrong_suite(track)
        suite = suite_of(track)
    except UnknownSuiteError as error:
        check.skip(str(error), played)
        return
    if seed is None:
        check.skip(WRONG_SECRET if is_opened else NOT_OPENED, played)
        return
    check.checked = known
    check.skip(NOT_KNOWN, played - known)
    report.findings += wrong_draws(track, suite, seed, file, recorded)

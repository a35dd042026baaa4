"""The boards that follow from matches: computed anew, and compared with those that are published."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from wildscav_evaluator.output.results import MetricInfo, metric_infos
from wildscav_evaluator.ratings.matches import RatedMatch
from wildscav_leaderboard.auditing.report import Finding, of_row, wrong_value
from wildscav_leaderboard.boards.documents import BoardDocument, Entry, LadderBoard, SuiteBoard
from wildscav_leaderboard.boards.ladder_board import Enough, ladder_board
from wildscav_leaderboard.boards.ladders import Played, placed_match, places_of
from wildscav_leaderboard.boards.suite_board import SuiteResults, suite_board
from wildscav_leaderboard.publishing.documents import (
    BoardFile,
    PublishedMatch,
    PublishedSeason,
    PublishedSubmission,
    PublishedTrack,
)
from wildscav_leaderboard.seasons.editions import digest_of


def computed_board(
    track: PublishedTrack, published: BoardDocument, file: BoardFile, matches: Sequence[PublishedMatch]
) -> BoardDocument:
    """Return the board that follows from matches.

    Args:
        published: The published board, the source of its conditions and of who takes part.
        file: The board's file, the source of the submissions' names.
        matches: Those that count, with the metrics that they really have.
    """
    arrived = [match.at for match in matches if match.at is not None]
    updated = max([published.updated, *arrived])
    numbers = set(published.entered)
    entered = [one for one in file.submissions if one.id in numbers]
    metrics = _metrics(track.name, published.metrics)
    if isinstance(published, LadderBoard):
        return _ladder(track, published, entered, matches).model_copy(update={"updated": updated})
    played: dict[int, list[PublishedMatch]] = {}
    for match in matches:
        if match.submission is not None and match.metrics is not None and not match.superseded:
            played.setdefault(match.submission, []).append(match)
    results = [_suite_results(track, one, played.get(one.id, ())) for one in entered]
    return suite_board(track.name, published.conditions, metrics, results, updated)


def _metrics(track: str, published: Sequence[MetricInfo]) -> tuple[MetricInfo, ...]:
    """Return the descriptions of a track's metrics, and of those that its matches request in addition."""
    own = {metric.name for metric in metric_infos(track)}
    return metric_infos(track, [metric.name for metric in published if metric.name not in own])


def _suite_results(
    track: PublishedTrack, one: PublishedSubmission, played: Sequence[PublishedMatch]
) -> SuiteResults:
    return SuiteResults(
        entry=Entry.of(one, one.team, one.team_title),
        planned=track.planned,
        faults=sum(any(seat.fault is not None for seat in match.seats) for match in played),
        metrics={match.number: match.metrics for match in played if match.metrics is not None},
    )


def _ladder(
    track: PublishedTrack,
    published: LadderBoard,
    entered: Sequence[PublishedSubmission],
    matches: Sequence[PublishedMatch],
) -> LadderBoard:
    own = digest_of(published.conditions)
    rated, faults = list[RatedMatch](), dict[str, int]()
    for match in matches:
        if match.void is not None or match.conditions != own or match.superseded:
            continue
        if len(rated) == published.applied:
            break
        names = [seat.entrant for seat in match.seats]
        places = places_of(track.name, [seat.metrics for seat in match.seats])
        rated.append(placed_match(match.number, list(zip(names, places, strict=True))))
        for seat in match.seats:
            faults[seat.entrant] = faults.get(seat.entrant, 0) + (seat.fault is not None)
    entrants = [Entry.of(one, one.team, one.team_title) for one in entered]
    entrants += Entry.of_robots(track.robots)
    played, enough = Played(tuple(rated), faults), Enough(track.interval or 0.0, track.planned)
    conditions, metrics = published.conditions, metric_infos(track.name)
    return ladder_board(track.name, conditions, metrics, entrants, played, enough, published.updated)


def differences(published: BoardDocument, computed: BoardDocument) -> Iterator[Finding]:
    """Yield every field in which a published board differs from the one that follows from the matches."""
    whole, right = published.model_dump(mode="json"), computed.model_dump(mode="json")
    del whole["rows"], right["rows"]
    for name, value, expected in _differing("", whole, right):
        yield wrong_value(name, value, expected)
    order = [_key(row) for row in published.rows]
    right_order = [_key(row) for row in computed.rows]
    expected_rows = dict(zip(right_order, computed.rows, strict=True))
    for key, row in zip(order, published.rows, strict=True):
        if key not in expected_rows:
            yield Finding("has a row, and should have none", **of_row(row))
            continue
        pair = row.model_dump(mode="json"), expected_rows[key].model_dump(mode="json")
        for name, value, expected in _differing("", *pair):
            yield wrong_value(name, value, expected, **of_row(row))
    for key, expected_row in expected_rows.items():
        if key not in order:
            yield Finding("has no row, and should have one", **of_row(expected_row))
    if order != right_order and sorted(order) == sorted(right_order):
        yield Finding(f"the rows are in the order {', '.join(order)}, must be in {', '.join(right_order)}")


def _key(row: Any) -> str:
    return str(row.team or f"robot:{row.name}")


def _differing(name: str, published: Any, expected: Any) -> Iterator[tuple[str, Any, Any]]:
    """Yield the path of every value that differs, with what it is and what it must be."""
    if isinstance(published, Mapping) and isinstance(expected, Mapping):
        for key in {**published, **expected}:
            path = f"{name}.{key}" if name else str(key)
            yield from _differing(path, published.get(key), expected.get(key))
    elif isinstance(published, list) and isinstance(expected, list) and len(published) == len(expected):
        for index, (one, other) in enumerate(zip(published, expected, strict=True)):
            yield from _differing(f"{name}.{index}", one, other)
    elif published != expected or type(published) is not type(expected):
        yield name, published, expected


def wrong_counts(board: BoardDocument, file: BoardFile) -> Iterator[Finding]:
    """Yield which rows count other matches than those that are published, while the results are hidden."""
    played = Counter(match.submission for match in file.matches if not match.superseded)
    for row in board.rows:
        if row.matches != played[row.submission]:
            yield wrong_value("matches", row.matches, played[row.submission], **of_row(row))


def wrong_conditions(
    board: BoardDocument, track: PublishedTrack, season: PublishedSeason
) -> Iterator[Finding]:
    """Yield in what the conditions of a board are not those of the season."""
    if board.track != track.name:
        yield wrong_value("track", board.track, track.name)
    if board.mode != track.mode:
        yield wrong_value("mode", board.mode, track.mode)
    commitment = season.secret_of(board.conditions.commitment).commitment
    for name, expected in (("suite", track.suite), ("commitment", commitment)):
        found = getattr(board.conditions, name)
        if found != expected:
            yield wrong_value(f"conditions.{name}", found, expected)
    if isinstance(board, SuiteBoard) and board.conditions.rounds != track.rounds:
        yield wrong_value("conditions.rounds", board.conditions.rounds, track.rounds)

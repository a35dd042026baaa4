"""Whether the matches of a board's file agree with each other, and with who takes part in its board."""

from collections import Counter
from collections.abc import Iterator

from wildscav_evaluator.output.results import mean_metrics
from wildscav_evaluator.seats import ROBOT_ENTRANT
from wildscav_leaderboard.auditing.report import Finding, of_match, wrong_value
from wildscav_leaderboard.boards.documents import BoardDocument, LadderBoard
from wildscav_leaderboard.matches.models import FINAL, LADDER, SUITE
from wildscav_leaderboard.publishing.documents import BoardFile, PublishedMatch, PublishedTrack
from wildscav_leaderboard.seasons.editions import digest_of


def wrong_matches(
    track: PublishedTrack, board: BoardDocument, file: BoardFile, *, final: bool
) -> Iterator[Finding]:
    """Yield what is wrong with the matches and the submissions of a track, without their records.

    Args:
        final: Whether the board is that of the matches that decide the season.
    """
    for number in board.entered:
        if number not in file.by_number:
            yield Finding("takes part in the board, but nothing is published of it", submission=number)
    for number, count in Counter(board.entered).items():
        if count > 1:
            yield Finding("takes part in the board twice", submission=number)
    numbers = [match.id for match in file.matches]
    if numbers != sorted(set(numbers)):
        yield Finding("the matches are not in the order in which they were made, or one is named twice")
    if isinstance(board, LadderBoard):
        yield from _wrong_numbers_of_ladder(file)
    else:
        yield from _wrong_numbers_of_suite(track, file)
    yield from _wrongly_superseded(file)
    kind = LADDER if isinstance(board, LadderBoard) else FINAL if final else SUITE
    conditions = digest_of(board.conditions)
    for match in file.matches:
        if match.kind != kind or (match.submission is None) != (kind == LADDER):
            yield wrong_value("kind", match.kind, kind, **of_match(match, file))
        elif match.void is None and not match.withheld:
            yield from _wrong_match(match, board, file, conditions)


def _wrongly_superseded(file: BoardFile) -> Iterator[Finding]:
    """Yield which results count no more although no later judging of the same match has taken their place."""
    last: dict[tuple[int | None, int, str], int] = {}
    for match in file.matches:
        key = match.submission, match.number, match.conditions
        last[key] = max(last.get(key, 0), match.judging if match.void is None else 0)
    for match in file.matches:
        if match.superseded != (match.judging < last[match.submission, match.number, match.conditions]):
            yield wrong_value("superseded", match.superseded, not match.superseded, **of_match(match, file))


def _wrong_numbers_of_ladder(file: BoardFile) -> Iterator[Finding]:
    """Check that no match of the ladder is left out, not even one that was given up."""
    expected = 0
    for match in file.matches:
        if match.judging > 1 and match.number < expected:
            continue
        for missing in range(expected, min(match.number, expected + 20)):
            yield Finding(f"the ladder's match number {missing} is missing")
        if match.number < expected:
            yield Finding(
                f"it is number {match.number} of the ladder, as another one is", **of_match(match, file)
            )
        expected = max(expected, match.number + 1)


def _wrong_numbers_of_suite(track: PublishedTrack, file: BoardFile) -> Iterator[Finding]:
    seen: set[tuple[int | None, int]] = set()
    for match in file.matches:
        place = of_match(match, file)
        if match.superseded:
            continue
        if (match.submission, match.number) in seen:
            yield Finding(f"the submission has two results of match number {match.number}", **place)
        if not 0 <= match.number < track.planned:
            yield Finding(f"the suite has no match number {match.number}, only {track.planned}", **place)
        seen.add((match.submission, match.number))


def _wrong_match(
    match: PublishedMatch, board: BoardDocument, file: BoardFile, conditions: str
) -> Iterator[Finding]:
    place = of_match(match, file)
    if match.kind != LADDER and match.conditions != conditions:
        yield Finding("it was not played under the conditions of the board", **place)
    if not match.seats or len({seat.seat for seat in match.seats}) < len(match.seats):
        yield Finding("it has no seats, or one of them twice", **place)
        return
    if match.at is None or match.at > board.updated:
        yield Finding(f"it arrived at {match.at}, after the time of the board, {board.updated}", **place)
    names = {metric.name for metric in board.metrics}
    for seat in match.seats:
        if missing := sorted((names | match.seats[0].metrics.keys()) - seat.metrics.keys()):
            yield Finding(f"seat {seat.seat} has no {', '.join(missing)}", **place)
            return
    mean = mean_metrics([seat.metrics for seat in match.seats])
    for name in {**mean, **(match.metrics or {})}:
        found = (match.metrics or {}).get(name)
        if found != mean.get(name):
            yield wrong_value(f"metrics.{name}", found, mean.get(name), **place)
    yield from _wrong_entrants(match, file)


def _wrong_entrants(match: PublishedMatch, file: BoardFile) -> Iterator[Finding]:
    known, place = file.by_number, of_match(match, file)
    for seat in match.seats:
        if seat.submission is None and not seat.entrant.startswith(ROBOT_ENTRANT):
            yield Finding(f"seat {seat.seat} belongs to {seat.entrant}, which is no robot", **place)
        own = known.get(seat.submission) if seat.submission is not None else None
        if own is not None and own.entrant != seat.entrant:
            yield wrong_value(f"seats.{seat.seat}.entrant", seat.entrant, own.entrant, **place)
        if match.submission is not None and seat.submission != match.submission:
            yield wrong_value(f"seats.{seat.seat}.submission", seat.submission, match.submission, **place)
    if match.submission is not None and match.submission not in known:
        yield Finding("its submission does not take part in the board", **place)

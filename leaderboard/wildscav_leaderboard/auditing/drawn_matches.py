"""Whether matches are those that the season's secret gives, so that nobody could choose maps or seats."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from wildscav.errors import UserError
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.suites.seeds import SuiteSeed
from wildscav_evaluator.suites.suite import SUITES, Suite, match_count, matches_in_rounds
from wildscav_evaluator.suites.suite_file import read_suite
from wildscav_leaderboard.auditing.records import Recorded
from wildscav_leaderboard.auditing.report import Check, Finding, of_match, wrong_value
from wildscav_leaderboard.boards.matchmaking import REPEATS, ladder_match, seated
from wildscav_leaderboard.matches.models import LADDER
from wildscav_leaderboard.publishing.documents import BoardFile, PublishedMatch, PublishedTrack
from wildscav_leaderboard.seasons.editions import digest_of, sha256_of


class UnknownSuiteError(UserError):
    """A suite is not known here."""


def suite_of(track: PublishedTrack) -> Suite:
    """Return the suite of a track.

    Raises:
        UnknownSuiteError: It is an organizer's own that is not published yet, or of a package.
        UserError: Its file is not valid.
    """
    if track.suite_digest is None:
        if track.suite in SUITES and SUITES[track.suite].label == track.suite:
            return SUITES[track.suite]
        raise UnknownSuiteError(f"the suite {track.suite} is not installed here")
    if track.suite_file is None:
        raise UnknownSuiteError("the organizer's own suite is published when the secret is opened")
    with TemporaryDirectory() as folder:
        path = Path(folder) / "suite.toml"
        path.write_text(track.suite_file, "utf-8", newline="")
        return read_suite(path)


def wrong_suite(track: PublishedTrack) -> Iterator[Finding]:
    """Yield in what a suite is not the one that was announced, as far as it is known.

    Raises:
        UnknownSuiteError: It is not.
    """
    suite = suite_of(track)
    if track.suite_file is not None:
        found = sha256_of(track.suite_file.encode())
        if found != track.suite_digest:
            yield wrong_value("suite_digest", track.suite_digest, found)
    if suite.label != track.suite:
        yield wrong_value("suite", track.suite, suite.label)
    if track.name not in suite.tracks:
        yield Finding(f"the suite {track.suite} does not have the track")
    elif track.mode == "suite" and (count := match_count(suite, track.name, track.rounds)) != track.planned:
        yield wrong_value("planned", track.planned, count)


def wrong_draws(
    track: PublishedTrack, suite: Suite, seed: SuiteSeed, file: BoardFile, recorded: Mapping[int, Recorded]
) -> Iterator[Finding]:
    """Yield which matches are not those that the secret gives, of those whose records are known."""
    conditions = "" if file.board is None else digest_of(file.board.conditions)
    specs = matches_in_rounds(suite, track.name, seed.value, track.rounds) if track.mode == "suite" else ()
    for match in file.matches:
        found = recorded.get(match.id)
        if found is None or found.spec is None or match.conditions != conditions:
            continue  # of a ladder's earlier edition
        place = of_match(match, file)
        yield from _wrong_seeds(match, found, file, seed)
        if match.kind != LADDER:
            if match.number >= len(specs) or specs[match.number] != found.spec:
                yield Finding(f"it is not match number {match.number} that the secret gives", **place)
            continue
        spec, seats = ladder_match(suite, track.name, seed.value, match.number, _names(match))
        if spec != found.spec or seats != _seats(match):
            yield Finding(
                f"its map or its seats are not those of the ladder's match number {match.number} that the "
                "secret gives",
                **place,
            )


def _wrong_seeds(
    match: PublishedMatch, found: Recorded, file: BoardFile, seed: SuiteSeed
) -> Iterator[Finding]:
    """Yield which seats were told another private seed than follows from the secret and the submission."""
    if found.spec is None or not found.seeds or found.faults:
        return
    told = sorted((one.seat, one.submission) for one in match.seats if one.submission is not None)
    known = [file.by_number.get(number) for _, number in told]  # not of those that left the board
    private = seed.private(found.spec, ["" if one is None else one.digest for one in known])
    for (seat, number), own, right in zip(told, known, private, strict=True):
        if own is not None and found.seeds[seat] != right:
            yield Finding(
                f"seat {seat} was told a private seed that does not follow from the secret",
                match=match.id,
                submission=number,
                team=own.team,
            )


def wrong_games(file: BoardFile, recorded: Mapping[int, Recorded], check: Check) -> Iterator[Finding]:
    """Yield what is wrong with the games of a ladder, as far as that can be told without the secret.

    The seats follow from the game's own seed, and both matches of a game are played on its map.
    """
    games: dict[int, tuple[object, ...]] = {}
    for match in file.matches:
        found = recorded.get(match.id)
        if found is None or found.spec is None or match.kind != LADDER:
            continue
        check.checked += 1
        spec: MatchSpec = found.spec
        right, seats = seated(spec, match.number % REPEATS, _names(match))
        if right != spec or seats != _seats(match):
            yield Finding(
                f"the seats must be {_shown(seats)}, and are {_shown(_seats(match))}", match=match.id
            )
        game = match.number // REPEATS
        drawn = (spec.map, spec.seed, sorted(spec.seats))
        if games.setdefault(game, drawn) != drawn:
            yield Finding("the other match of the same game was played on another map", match=match.id)


def _names(match: PublishedMatch) -> list[str]:
    return sorted(seat.entrant for seat in match.seats)


def _seats(match: PublishedMatch) -> dict[int, str]:
    return {seat.seat: seat.entrant for seat in match.seats}


def _shown(seats: Mapping[int, str]) -> str:
    return ", ".join(f"{name} in {seat}" for seat, name in sorted(seats.items()))

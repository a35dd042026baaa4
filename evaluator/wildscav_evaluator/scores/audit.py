"""Checking that an output folder supports its results: its parts agree, and nothing is missing.

Records prove which scores their actions give. The rest (who played, in which sandbox, and that nothing was
left out) must at least be the same in ``results.json``, ``evaluation.json`` and the ledger. It is proven only
if an organizer signed the ledger.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from wildscav.errors import UserError
from wildscav.terminal.console import counted, printable
from wildscav_engine.record.format import WITHOUT_SEEDS
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.ledger.entries import MatchEnded
from wildscav_evaluator.ledger.ledger import Ledger, LedgerError, check_key, read_ledger, sha256_of
from wildscav_evaluator.output.identity import Identity, digest_of, read_identity
from wildscav_evaluator.output.layout import EXCHANGES, IDENTITY_FILE, LEDGER_FILE, RESULTS_FILE, stem_of
from wildscav_evaluator.output.results import FAILED, Evaluation, MatchRow, Results, TournamentSettings
from wildscav_evaluator.scores.compare import check_comparison
from wildscav_evaluator.scores.expected_matches import (
    ExpectedMatch,
    expected_matches,
    judge_of,
    kind_of,
    known_seed,
    match_counts,
)
from wildscav_evaluator.scores.rescore import Replayed, disagreements
from wildscav_evaluator.seats import robot_entrant, submission_seats
from wildscav_evaluator.tournaments.tournament_file import check_tournament

MAX_NAMED = 20  # missing matches that are named individually
# In both files.
SAME = (
    "versions",
    "suite",
    "commitment",
    "rounds",
    "sandbox",
    "limits",
    "key",
    "tournament",
    "clock",
    "model",
)


@dataclass(frozen=True)
class AuditedFolder:
    """The contents of an evaluation's output folder, except its records."""

    out: Path
    reported: Results
    identity: Identity | None  # None if its file is missing
    ledger: Ledger | None  # None if it is missing or broken
    fault: str  # why there is no reliable ledger, or empty
    key: str | None  # the public key that must have signed the ledger

    @property
    def signed(self) -> bool:
        """Whether the organizer whose key is known signed the ledger."""
        return self.key is not None and self.ledger is not None and self.ledger.key == self.key


def read_folder(out: Path, reported: Results, key: str | None) -> AuditedFolder:
    """Read the identity and the ledger of an output folder.

    ``key`` is the public key that must have signed its ledger; None for any. UserError if its results have an
    unknown track, or an evaluation twice.
    """
    names = Counter((one.track, one.submission) for one in reported.evaluations)
    for (track, submission), count in names.items():
        if track not in TRACKS:
            raise UserError(f"{out / RESULTS_FILE}: there is no track {printable(track)!r}")
        if count > 1:
            raise UserError(f"{out / RESULTS_FILE}: {printable(submission)} has two results on {track}")
    ledger, fault = None, f"there is no {out / LEDGER_FILE}: nothing shows that no match was left out"
    try:
        ledger = read_ledger(out)
        if key is not None:
            check_key(ledger, key, out)
        fault = "" if ledger is not None else fault
    except LedgerError as error:
        fault = str(error)
    return AuditedFolder(out, reported, read_identity(out), ledger, fault, key)


def discrepancies(folder: AuditedFolder, replayed: Sequence[Replayed], recomputed: Results) -> Iterator[str]:
    """Yield one line for each claim of an output folder that its contents do not support.

    ``recomputed`` are its results, with the numbers that follow from the records. Errors: see
    ``expected_matches``.
    """
    expected = expected_matches(folder.out, folder.reported)
    judge = judge_of(folder.out, folder.reported, expected)
    counts = match_counts(folder.out, folder.reported)
    yield from _of_identity(folder)
    yield from _of_suite(folder, replayed, expected)
    yield from _of_rows(folder, counts, expected)
    settings = folder.reported.tournament
    if settings is not None and expected is None:
        yield from deviations(folder.reported, settings, replayed, max(counts.values(), default=0))
    yield from disagreements(replayed, folder.reported, recomputed.evaluations, judge)
    if folder.reported.overall != recomputed.overall:
        yield f"the ratings across tracks in {RESULTS_FILE} are not those that the records give"
    for one in replayed:
        if one.versions is not None and one.versions != folder.reported.versions:
            said = folder.reported.versions
            yield f"{one.record}: was played by {one.versions}, but the results say {said}"
    yield from _of_seeds(folder, replayed)
    yield from _of_ledger(folder)
    if fault := check_comparison(folder.out, folder.reported):
        yield fault
    if fault := check_tournament(folder.out, recomputed):
        yield fault


def _of_identity(folder: AuditedFolder) -> Iterator[str]:
    """Compare the results with the evaluation's identity."""
    reported, identity = folder.reported, folder.identity
    if identity is None:
        yield f"there is no {folder.out / IDENTITY_FILE}: without it, the entrants are not known"
        return
    for name in SAME:
        if getattr(reported, name) != getattr(identity, name):
            yield (
                f"{RESULTS_FILE} says {name} {_shown(reported, name)}, "
                f"{IDENTITY_FILE} {_shown(identity, name)}"
            )
    if reported.seed_label != identity.seed:
        yield f"{RESULTS_FILE} says seed {reported.seed_label}, {IDENTITY_FILE} {identity.seed}"
    entered = {
        (track, one.name): (one.version, one.digest, one.interface)
        for one in identity.submissions
        for track in one.tracks
    }
    listed = {
        (one.track, one.submission): (one.version, one.digest, one.interface) for one in reported.evaluations
    }
    for track, name in sorted(entered.keys() | listed.keys()):
        who = f"{name} on {track}"
        if (track, name) not in listed:
            yield f"{who}: {IDENTITY_FILE} names it as an entrant, but there are no results"
        elif (track, name) not in entered:
            yield f"{who}: there are results, but {IDENTITY_FILE} does not name it as an entrant"
        elif listed[track, name] != entered[track, name]:
            yield f"{who}: {RESULTS_FILE} and {IDENTITY_FILE} name another version, files or interface"


def _shown(part: Results | Identity, name: str) -> str:
    value = getattr(part, name)
    return "none" if value is None else str(value)


def _of_suite(
    folder: AuditedFolder,
    replayed: Sequence[Replayed],
    expected: Mapping[str, Sequence[ExpectedMatch]] | None,
) -> Iterator[str]:
    """Check that all entrants played the same matches, and that these are the planned ones."""
    specs: dict[tuple[str, int], MatchSpec] = {}
    for one in replayed:
        if one.spec is not None and specs.setdefault((one.track, one.index), one.spec) != one.spec:
            yield f"{one.record}: another submission played a different match {one.index} of {one.track}"
    identity = folder.identity
    if identity is None or set(identity.tracks) != set(folder.reported.tracks):
        return
    if expected is not None:
        played = [match.spec for track in identity.tracks for match in expected.get(track, ())]
    else:
        counts = match_counts(folder.out, folder.reported)
        places = [(track, index) for track in identity.tracks for index in range(counts.get(track, 0))]
        if not all(place in specs for place in places):
            return
        played = [specs[place] for place in places]
    if digest_of(played) != identity.matches:
        yield f"the matches of the {kind_of(folder.reported)} are not those that {IDENTITY_FILE} names"


def _of_rows(
    folder: AuditedFolder,
    counts: Mapping[str, int],
    expected: Mapping[str, Sequence[ExpectedMatch]] | None,
) -> Iterator[str]:
    """Check that every match is in the results, and that its values are consistent."""
    kind = kind_of(folder.reported)
    planned = _planned_matches(folder.reported, counts, expected)
    for evaluation in folder.reported.evaluations:
        who, count = f"{evaluation.submission} on {evaluation.track}", counts.get(evaluation.track, 0)
        indices = [row.index for row in evaluation.matches]
        known = {*indices}
        own = planned.get((evaluation.track, evaluation.submission), ())
        absent = (index for index in own if index not in known)
        for index in islice(absent, MAX_NAMED):
            yield f"{who}: match {index} of the {kind} is not in the results"
        if more := sum(1 for _ in absent):
            yield f"{who}: {more:,} more matches of the {kind} are not in the results"
        for index in sorted(index for index in known if not 0 <= index < count):
            yield f"{who}: match {index} is in the results, but the {kind} has only {count}"
        if len(indices) > len({*indices}):
            yield f"{who}: a match is in the results twice"
        for row in evaluation.matches:
            yield from _of_row(folder, evaluation, row)


def _planned_matches(
    reported: Results, counts: Mapping[str, int], expected: Mapping[str, Sequence[ExpectedMatch]] | None
) -> Mapping[tuple[str, str], Sequence[int]]:
    """Return the numbers of the matches that each submission should have played, as far as they are known."""
    if reported.tournament is None:
        return {(one.track, one.submission): range(counts.get(one.track, 0)) for one in reported.evaluations}
    planned: dict[tuple[str, str], list[int]] = {}
    for track, matches in (expected or {}).items():
        for index, match in enumerate(matches):
            for name in match.entrants:
                planned.setdefault((track, name), []).append(index)
    return planned


def _of_row(folder: AuditedFolder, evaluation: Evaluation, row: MatchRow) -> Iterator[str]:
    who = f"{evaluation.submission} on {evaluation.track}, match {row.index}"
    if row.record is not None:
        played = row.model_copy(update={"replay": None})
        if not row.seats or MatchRow.of(row.index, row.seats, row.record) != played:
            yield f"{who}: its summary is not that of its seats"
        if any(seat.fault == "platform" for seat in row.seats) or row.fault == "platform":
            yield f"{who}: it was played, but is marked as the platform's fault"
        return
    if (row.status, row.fault) != (FAILED, "platform"):
        yield f"{who}: there is no record of it, though the results say that it was played"
    elif not folder.signed:
        yield (
            f"{who}: there is no record of it; only a ledger that the organizer signed (--key) "
            "can prove that the platform failed"
        )


def _of_seeds(folder: AuditedFolder, replayed: Sequence[Replayed]) -> Iterator[str]:
    """Check that agents were told the private seeds that follow from the evaluation's seed, once known."""
    seed = known_seed(folder.out, folder.reported)
    digests = {one.submission: one.digest for one in folder.reported.evaluations}
    for one in replayed:
        if seed is None or one.spec is None or (one.versions and one.versions.record == WITHOUT_SEEDS):
            continue
        seats = submission_seats(one.spec.seats)
        entrants = [one.submission or one.entrants[seat] for seat in seats]
        private = seed.private(one.spec, [digests.get(name, "") for name in entrants])
        if private != tuple(one.seeds[seat] for seat in seats):
            yield f"{one.record}: its agents were not told the private seeds that follow from the seed"


def _of_ledger(folder: AuditedFolder) -> Iterator[str]:
    """Compare the results with the ledger."""
    reported, ledger = folder.reported, folder.ledger
    if folder.fault:
        yield folder.fault
    if ledger is None:
        return
    if folder.identity is not None and ledger.identity != folder.identity:
        yield f"{IDENTITY_FILE} is not what {LEDGER_FILE} was opened with"
    if ledger.closed is None:
        yield f"{LEDGER_FILE} is not closed: the evaluation was not completed, or its end was cut off"
    elif ledger.closed.results != sha256_of(folder.out / RESULTS_FILE):
        yield f"{RESULTS_FILE} is not the file that {LEDGER_FILE} was closed with"
    yield from _of_matches(folder.out, reported, ledger.ended)


def _of_matches(out: Path, reported: Results, ended: Mapping[str, Sequence[MatchEnded]]) -> Iterator[str]:
    """Compare each match in the results with the ledger."""
    timings = {(one.submission, one.track, one.index): one for one in reported.timings.matches}
    known = set()
    for evaluation in reported.evaluations:
        evaluated = evaluation.submission if reported.tournament is None else None
        for row in evaluation.matches:
            match = stem_of(evaluation.track, row.index, evaluated)
            times = ended.get(match, ())
            timing = timings.get((evaluated, evaluation.track, row.index))
            played = row.model_copy(update={"replay": None})
            if not times:
                yield f"{match}: is in the results, but not in {LEDGER_FILE}"
            elif (_row_of(times[-1], evaluation, reported), times[-1].timing) != (played, timing):
                yield f"{match}: {RESULTS_FILE} and {LEDGER_FILE} disagree about it"
            if match not in known:
                yield from _of_ended(out, match, times)
            known.add(match)
    for match in ended:
        if match not in known:
            yield f"{match}: is in {LEDGER_FILE}, but not in the results"


def _row_of(ended: MatchEnded, evaluation: Evaluation, reported: Results) -> MatchRow:
    """Return how a match ended for one submission, according to the ledger."""
    return ended.row if reported.tournament is None else ended.row.of_entrant(evaluation.submission)


def _of_ended(out: Path, match: str, times: Sequence[MatchEnded]) -> Iterator[str]:
    """Check that a match was played once, and that its record is the one in the ledger."""
    if any(one.record is not None for one in times[:-1]):
        yield f"{match}: was played more than once"
    last = times[-1] if times else None
    if last is None or last.row.record is None or last.record is None:
        return
    path = out / last.row.record
    if path.is_file() and sha256_of(path) != last.record:
        yield f"{match}: its record is not the one that {LEDGER_FILE} names"
    asked = out / EXCHANGES / f"{match}.jsonl.gz"
    if asked.is_file() and sha256_of(asked) != last.exchanges:
        yield f"{match}: what its agents asked a model is not what {LEDGER_FILE} names"


def deviations(
    reported: Results, settings: TournamentSettings, replayed: Sequence[Replayed], count: int
) -> Iterator[str]:
    """Yield one line for each deviation of a tournament from what is known of its schedule without the seed.

    Which entrants meet in which match is known only once the secret is opened, and not of a schedule of an
    earlier version. But every match has as many entrants and the same kinds of seats, a game is played again
    by the same entrants, and everyone plays equally often. This is enough to notice a match that was left
    out, and a seat that was given to another entrant.
    """
    entrants = Counter(row.index for one in reported.evaluations for row in one.matches)
    for index in range(count):
        if entrants[index] != settings.places:
            yield (
                f"match {index} of the tournament has results of {counted(entrants[index], 'entrant')}, "
                f"must be {settings.places}"
            )
    share = count * settings.places // len(reported.evaluations)
    for one in reported.evaluations:
        if len(one.matches) != share:
            yield (
                f"{one.submission} on {one.track}: {counted(len(one.matches), 'match')} in the results, but "
                f"every entrant of the tournament plays {share:,}"
            )
    in_game: dict[int, set[str]] = {}
    for played in replayed:
        if played.spec is None:
            continue
        if not _is_seated(played, settings):
            yield f"{played.record}: its seats are not filled as the settings of the tournament say"
        names = {*played.entrants.values()}
        if in_game.setdefault(played.index // settings.repeats, names) != names:
            yield f"{played.record}: other entrants play in it than in another match of the same game"


def _is_seated(played: Replayed, settings: TournamentSettings) -> bool:
    """Return whether entrants, their teams and other robots fill the seats of a record as they should."""
    if played.spec is None:
        return False
    entrants, teams = played.entrants, played.spec.team_of_seats
    others = [kind for seat, kind in enumerate(played.spec.seats) if seat not in entrants]
    members: dict[int, list[str]] = {}
    for seat, name in entrants.items():
        members.setdefault(teams[seat], []).append(name)
    different = settings.team_size if settings.mixed else 1  # entrants in a team
    kinds = [(name, played.spec.seats[seat]) for seat, name in entrants.items()]
    return (
        len(entrants) == settings.seats
        and all(kind == SUBMISSION or name == robot_entrant(kind) for name, kind in kinds)
        and len({*entrants.values()}) == settings.places
        and sorted(others) == sorted(settings.robots)
        and all(len(team) == settings.team_size and len({*team}) == different for team in members.values())
    )

"""Which editions are in force, and the season that follows from them."""

from datetime import datetime
from weakref import WeakKeyDictionary

from sqlalchemy import select
from sqlalchemy.orm import Session

from wildscav_evaluator.output.results import CURRENT_VERSIONS, KeptLimits, ModelTerms, metric_infos
from wildscav_evaluator.sandbox import SANDBOXES
from wildscav_evaluator.sandbox.limits import KEPT_ANYWHERE
from wildscav_evaluator.suites.suite import match_count
from wildscav_leaderboard.seasons.editions import Conditions, Edition, digest_of, sha256_of
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.models import EditionRow
from wildscav_leaderboard.seasons.state import EDITIONS, NODES, read_state, write_state

_known: "WeakKeyDictionary[Season, Season]" = WeakKeyDictionary()  # by the season as it is written


def edition_of(season: Season, track: str, sandbox: str) -> Edition:
    """Return the edition that follows from the files of a season, in force or not.

    Args:
        season: The season as its folder says.
    """
    settings, suite = season.track(track), season.suite(track)
    is_ladder = settings.mode == "ladder"
    kept = None if SANDBOXES[sandbox].isolated else KEPT_ANYWHERE
    drawn = suite.matches(track, season.seed.value)
    conditions = Conditions(
        versions=CURRENT_VERSIONS,
        suite=suite.label,
        suite_digest=sha256_of(suite.source),
        mode=settings.mode,
        rounds=1 if is_ladder else settings.rounds,
        seats=settings.seats if is_ladder else 1,
        robots=settings.robots if is_ladder else (),
        commitment=str(season.seed.commitment),
        sandbox=sandbox,
        limits=KeptLimits(**season.limits(track).model_dump(include=kept)),
        model=model_of(season),
    )
    return Edition(
        settings=settings,
        suite_file=None if suite.source is None else suite.source.decode(),
        conditions=conditions,
        final_commitment=str(season.final_seed.commitment),
        matches=match_count(suite, track, conditions.rounds),
        metrics=metric_infos(track, () if is_ladder else drawn[0].metrics),
    )


def in_force(session: Session, season: Season) -> Season:
    """Return a season with the rules that are in force, whatever its folder says by now.

    Before the first edition there is, the rules are those of the folder: nobody has played.
    """
    numbers: dict[str, int] = read_state(session, EDITIONS) or {}
    if numbers == season.numbers:
        return season
    written = season.as_written or season
    known = _known.get(written)
    if known is None or known.numbers != numbers:
        wanted = select(EditionRow).where(EditionRow.id.in_(numbers.values()))
        editions = {row.track: Edition.model_validate(row.document) for row in session.scalars(wanted)}
        known = _known[written] = written.with_editions(editions, numbers)
    return known


def edition_numbers(session: Session) -> dict[str, int]:
    """Return the number of the edition that is in force on each track."""
    return dict(read_state(session, EDITIONS) or {})


def edition_by_number(session: Session, number: int | None) -> Edition:
    """Return an edition."""
    return Edition.model_validate(session.get_one(EditionRow, number).document)


def enter_edition(session: Session, track: str, edition: Edition | None, now: datetime) -> int | None:
    """Put an edition in force, which is stored if it is new; None ends the track. Return its number."""
    numbers = edition_numbers(session)
    if edition is None:
        numbers.pop(track, None)
        write_state(session, EDITIONS, numbers, now)
        return None
    digest = digest_of(edition.conditions)
    row = session.scalars(select(EditionRow).filter_by(track=track, digest=digest)).one_or_none()
    if row is None:
        document = edition.model_dump(mode="json")
        row = EditionRow(track=track, digest=digest, created=now, document=document)
        session.add(row)
        session.flush()
    write_state(session, EDITIONS, {**numbers, track: row.id}, now)
    return row.id


def model_of(season: Season) -> ModelTerms | None:
    """Return the model that submissions may ask by the settings, on its terms; None if there is none."""
    return None if season.settings.model is None else ModelTerms.about(season.settings.model)


def sandbox_of(session: Session, season: Season) -> str:
    """Return the sandbox in which agents run: that of the settings, else the one that was found to work."""
    nodes = read_state(session, NODES) or {}
    return str(season.settings.execution.sandbox or nodes.get("sandbox") or "process")

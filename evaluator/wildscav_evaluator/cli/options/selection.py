"""What a command is to play: the submissions, tracks, suite and seed that its arguments select.

What there is not, or cannot be played, is refused by a ``UserError``.
"""

from pathlib import Path

from pydantic import ValidationError

from wildscav.baselines import NAMES, baseline_folder, is_baseline
from wildscav.errors import UserError
from wildscav.terminal.suggestions import did_you_mean
from wildscav_engine.specs.thinking import ClockChoice
from wildscav_engine.specs.validation import one_line
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.submissions.images import IMAGE, load_image
from wildscav_evaluator.submissions.submission import Submission, load_submission
from wildscav_evaluator.suites.seeds import SuiteSeed, read_secret
from wildscav_evaluator.suites.suite import Suite
from wildscav_server.hosting.manifest import SubmissionError


def load_submissions(folders: list[Path]) -> tuple[Submission, ...]:
    """Read and check submissions."""
    return tuple(load_named(folder) for folder in folders)


def load_named(named: Path) -> Submission:
    """Read and check a submission: a folder, an archive, ``image:NAME`` or a baseline's name."""
    text = str(named)
    if text.startswith(IMAGE):
        return load_image(text.removeprefix(IMAGE))
    if is_baseline(text):
        return load_submission(baseline_folder(text))
    if not named.exists() and named.parent == Path() and (near := did_you_mean(text, NAMES)):
        raise SubmissionError(f"submission {text} does not exist{near}")
    return load_submission(named)


def tracks_played(submissions: tuple[Submission, ...], asked: list[str]) -> tuple[str, ...]:
    """Return the tracks to play, in the order of the registry."""
    for name in asked:
        check_track(name)
    wanted = [name for name in TRACKS if not asked or name in asked]
    for submission in submissions:
        if not set(wanted) & set(submission.manifest.tracks):
            check_plays(submission, wanted[0])
    return tuple(
        name for name in wanted if any(name in submission.manifest.tracks for submission in submissions)
    )


def check_track(name: str) -> None:
    """Refuse a name that no track has."""
    if name not in TRACKS:
        raise UserError(
            f"there is no track {name!r}{did_you_mean(name, TRACKS)}; the tracks are {', '.join(TRACKS)}",
            exit_code=2,
        )


def check_suite_has(suite: Suite, track: str) -> None:
    """Refuse a track that a suite does not have."""
    if track not in suite.tracks:
        raise UserError(
            f"suite {suite.name} has no track {track}; its tracks are {', '.join(suite.tracks)}", exit_code=2
        )


def suite_tracks(submissions: tuple[Submission, ...], asked: list[str], suite: Suite) -> tuple[str, ...]:
    """Return the tracks of a suite to play."""
    tracks = tracks_played(submissions, asked)
    for name in tracks if asked else ():
        check_suite_has(suite, name)
    played = tuple(name for name in tracks if name in suite.tracks)
    for submission in submissions:
        if not set(played) & set(submission.manifest.tracks):
            raise UserError(
                f"submission {submission.name!r} plays no track of suite {suite.name}, which has "
                f"{', '.join(suite.tracks)}",
                exit_code=2,
            )
    return played


def clock_choice(text: str, option: str = "") -> ClockChoice:
    """Return the clock that an option describes, such as ``running,pace=2``.

    ``option`` is what was given, if it was not ``--clock`` with the text.
    """
    option, (clock, *price) = option or f"--clock {text}", text.split(",")
    try:
        return ClockChoice.model_validate(
            {"clock": clock, "thinking": dict(part.split("=", 1) for part in price)}
        )
    except ValidationError as error:
        raise UserError(f"{option}: {one_line(error)}", exit_code=2) from error
    except ValueError:
        raise UserError(f"{option}: after the clock, every part must be NAME=NUMBER", 2) from None


def suite_seed(seed: int | None, secret: Path | None) -> SuiteSeed:
    """Return the seed that the options select."""
    if secret is None:
        return SuiteSeed(seed or 0)
    if seed is not None:
        raise UserError("--seed and --secret are given: the seed is public or hidden, not both", exit_code=2)
    return read_secret(secret)


def check_interface(submissions: tuple[Submission, ...], asked: str | None) -> None:
    """Refuse submissions that play by another interface than is asked for."""
    for one in submissions:
        if asked not in (None, one.manifest.interface):
            raise UserError(
                f"submission {one.name!r} plays by {one.manifest.interface}, as its submission.toml says, "
                f"and --interface is {asked}",
                exit_code=2,
            )


def check_plays(submission: Submission, track: str) -> None:
    """Refuse a submission that does not play a track."""
    if track not in submission.manifest.tracks:
        raise UserError(
            f"submission {submission.name!r} does not play {track}: the tracks in "
            f"{submission.folder / 'submission.toml'} are {', '.join(submission.manifest.tracks)}",
            exit_code=2,
        )

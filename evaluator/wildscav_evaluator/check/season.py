"""What a season says of how it validates submissions, so that ``wildscav check`` does the same."""

from http.client import HTTPException
from urllib.error import HTTPError
from urllib.request import urlopen

from pydantic import BaseModel, ValidationError

from wildscav.errors import UserError, describe
from wildscav_engine.specs.match_spec import SUBMISSION
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.check.trials import Trial
from wildscav_evaluator.sandbox.limits import Limits
from wildscav_evaluator.submissions.submission import NO_MODEL, Submission
from wildscav_evaluator.suites.suite import SUITES
from wildscav_evaluator.suites.suite_file import find_suite

LARGEST = 1 << 20  # bytes of an answer
TIMEOUT = 30.0  # s


class _Track(BaseModel):
    name: str
    suite: str
    seats: int


class _Validation(BaseModel):
    sandbox: str
    limits: dict[str, Limits]
    model: bool = False


class SeasonRules(BaseModel):
    """What matters here of what a season says of itself."""

    tracks: list[_Track]
    validation: _Validation

    @classmethod
    def of(cls, url: str) -> "SeasonRules":
        """Ask a season; UserError if it does not answer, or is none."""
        if not url.startswith(("http://", "https://")):
            raise UserError(f"--season is {url!r}, must be an address such as https://season.example.org", 2)
        try:
            with urlopen(f"{url.rstrip('/')}/api/v1/season", timeout=TIMEOUT) as answer:  # noqa: S310
                return cls.model_validate_json(answer.read(LARGEST))
        except (OSError, HTTPException, ValueError) as error:
            if isinstance(error, HTTPError):
                error.close()  # it is the answer, too, and has the connection
            why = "this is no season of this version" if isinstance(error, ValidationError) else error
            raise UserError(
                f"cannot ask the season {url}: {describe(why) if isinstance(why, OSError) else why}"
            ) from None

    def trials(self, submission: Submission, instead: str) -> dict[str, Trial]:
        """Return what to play on each track that the submission and the season have.

        ``instead`` is the suite that is played where the season's own is hidden. UserError if they have no
        track in common, or the submission asks a model and the season offers none.
        """
        tracks = [one for one in self.tracks if one.name in submission.manifest.tracks]
        if not tracks:
            raise UserError(f"the season has only {', '.join(one.name for one in self.tracks)}")
        if submission.manifest.model and not self.validation.model:
            raise UserError(NO_MODEL)
        return {one.name: self._trial(one, instead) for one in tracks}

    def _trial(self, track: _Track, instead: str) -> Trial:
        suite = find_suite(track.suite if track.suite in SUITES else instead)
        trial = Trial.of(suite, track.name, self.validation.limits[track.name], seed=0)
        if track.seats == 1:  # the suite says who plays
            return trial
        seats = (SUBMISSION, *(TRACKS[track.name].robot for _ in range(track.seats - 1)))
        return trial._replace(spec=trial.spec.model_copy(update={"seats": seats}))

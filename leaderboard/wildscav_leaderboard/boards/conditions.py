"""The conditions under which a season's matches are played."""

from wildscav_evaluator.output.results import KeptLimits
from wildscav_evaluator.output.versions import CURRENT_VERSIONS
from wildscav_evaluator.sandbox import SANDBOXES
from wildscav_evaluator.sandbox.limits import KEPT_ANYWHERE
from wildscav_leaderboard.boards.documents import Conditions
from wildscav_leaderboard.seasons.folder import Season


def conditions_of(season: Season, track: str, sandbox: str, *, final: bool = False) -> Conditions:
    """Return the conditions of the matches that are played now on a track.

    Args:
        season: The season.
        track: The track.
        sandbox: In which agents run.
        final: Whether it is about the matches that decide the season.
    """
    kept = None if SANDBOXES[sandbox].isolated else KEPT_ANYWHERE
    return Conditions(
        versions=CURRENT_VERSIONS,
        suite=season.suite(track).label,
        rounds=season.track(track).rounds,
        commitment=str((season.final_seed if final else season.seed).commitment),
        sandbox=sandbox,
        limits=KeptLimits(**season.limits(track).model_dump(include=kept)),
    )

"""Who plays in ``wildscav baselines``, and their matches with a progress bar."""

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from wildscav.errors import UserError

if TYPE_CHECKING:
    from wildscav_engine.envs import SeatController
    from wildscav_training.trials import Trial

    Played = dict[tuple[str, str], list[Trial]]  # by level or scenario, and agent

ALL = "all"


def baselines_of(track: str) -> list[str]:
    """Return the names of the baselines that play a track, between those that know the target."""
    from wildscav.baselines import NAMES, baseline_folder
    from wildscav.sdk.submission_folder import MANIFEST
    from wildscav_engine.tracks import TRACKS
    from wildscav_server.hosting.manifest import read_manifest

    names = [name for name in NAMES if track in read_manifest(baseline_folder(name) / MANIFEST).tracks]
    return ["straight", *names, "oracle"] if TRACKS[track].has_target else names


def players_of(tracks: Sequence[str], names: Iterable[str]) -> "dict[str, SeatController]":
    """Return agents by their names; a UserError if there is none, or it plays none of the tracks."""
    from wildscav_training.opponents import named_agent

    players = {name: named_agent(name) for name in names}
    for player in players.values():
        refusals = [refusal(player, track) for track in tracks]
        if all(refusals):
            raise UserError(refusals[0], exit_code=2)
    return players


def refusal(player: "SeatController", track: str) -> str:
    """Return why an agent does not play a track; nothing if it does."""
    try:
        player.check(track)
    except ValueError as error:
        return str(error)
    return ""


def play_all(matches: "Iterable[tuple[tuple[str, str], Callable[[], Trial]]]", total: int) -> "Played":
    """Play so many matches with a progress bar."""
    from wildscav.terminal.console import error_console, progress_bar
    from wildscav_engine.compilation.engine_progress import preparing

    played: Played = {}
    with preparing(error_console), progress_bar() as progress:
        task = progress.add_task("", total=total)
        for key, play in matches:
            progress.update(task, description=", ".join(key))
            played.setdefault(key, []).append(play())
            progress.advance(task)
    return played

"""Lets spectators follow matches of ladders while they are played."""

from contextlib import suppress
from pathlib import Path

from wildscav_evaluator.matches.jobs import Heartbeat, Job, JobEvent
from wildscav_leaderboard.spectating.live import LiveMatches


class Broadcast:
    """Writes what the heartbeats of watched matches bring, for the web server.

    That nobody can watch, because the disk is full, say, is no reason to stop a match.

    Args:
        folder: Of the running matches. What a conductor left there that was killed is removed.
    """

    def __init__(self, folder: Path) -> None:
        self._live = LiveMatches(folder)
        with suppress(OSError):
            self._live.clear()

    def note(self, job: Job, event: JobEvent) -> None:
        """Show what a match reports."""
        if isinstance(event, Heartbeat) and event.snapshots:
            with suppress(OSError):
                self._live.add(job.evaluation, job.spec, job.seating.names, event.snapshots)

    def end(self, job: Job) -> None:
        """Show a match no longer: its record tells everything."""
        with suppress(OSError):
            self._live.end(job.evaluation)

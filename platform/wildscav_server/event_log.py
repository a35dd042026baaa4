"""The log of a server: one structured line per event."""

import time
from typing import TYPE_CHECKING

from wildscav.wire.errors import RefusalError
from wildscav_server.monitoring.logs import Log

if TYPE_CHECKING:
    from wildscav_server.hosting.hosted_match import HostedMatch

PAUSE = 1.0  # s after a refusal in which others of its reason are only counted, so that floods fill no disk


class EventLog:
    """Writes the events of a server into a log, if there is one."""

    def __init__(self, log: Log | None) -> None:
        self._log = log
        self._refusals: dict[
            str, tuple[float, int]
        ] = {}  # by reason: time of the last line, count since then

    def match_opened(self, match: "HostedMatch") -> None:
        """Write that a match can be joined."""
        if self._log is not None:
            track = match.match.spec.track
            self._log.info("match_opened", match=match.id, track=track, seats=len(match.seats))

    def match_ended(self, match: "HostedMatch", how: str) -> None:
        """Write how a match and each of its seats ended: "finished", "failed" or "cancelled"."""
        if self._log is None:
            return
        about = {"match": match.id, "track": match.match.spec.track, "steps": match.match.step_number}
        if how == "failed":
            error = repr(match.task.exception())
            self._log.warning("match_failed", **about, fault="platform", error=error)
            return
        if how == "finished":
            self._seats_ended(match, self._log)
        self._log.info(f"match_{how}", **about)

    def _seats_ended(self, match: "HostedMatch", log: Log) -> None:
        for seat in match.seats.values():
            report = seat.report()
            write = log.warning if report.status.fault else log.info
            write(
                "seat_ended",
                match=match.id,
                seat=report.seat,
                sdk=seat.sdk,
                status=report.status.value,
                fault=report.status.fault,
                detail=report.detail,
                late_steps=report.late_steps,
                latency_p99=round(report.think_time.p99, 4),
                time_bank=round(report.time_bank, 3),
            )

    def stream_failed(self, address: str, error: Exception) -> None:
        """Write that the server failed to serve a stream before its seat was known."""
        if self._log is not None:
            self._log.warning("stream_failed", address=address, fault="platform", error=repr(error))

    def stream_refused(self, refusal: RefusalError) -> None:
        """Write that a stream was refused or ended by the server."""
        if self._log is None:
            return
        now = time.monotonic()
        written, since = self._refusals.get(refusal.reason, (-PAUSE, 0))
        if now - written < PAUSE:
            self._refusals[refusal.reason] = (written, since + 1)
            return
        self._refusals[refusal.reason] = (now, 0)
        self._log.warning("refused", reason=refusal.reason, detail=str(refusal), unwritten=since)

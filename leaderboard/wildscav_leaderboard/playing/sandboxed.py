"""A submission that plays against a person, in the sandbox and with the limits of the season."""

from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from pathlib import Path

from wildscav.server import HostedMatch
from wildscav_evaluator.matches.agents import MatchAgents
from wildscav_evaluator.matches.play import EXIT_TIME, launch_for
from wildscav_evaluator.sandbox import Limits, Sandbox
from wildscav_evaluator.submissions.submission import Submission

LOG = "agent.log"


class SandboxedAgents:
    """Runs one submission, in all seats that are not a person's. See ``wildscav.play.rounds.Agents``.

    Args:
        submission: The submission, ready for the sandbox.
        sandbox: The sandbox.
        limits: Of its agent.
    """

    def __init__(self, submission: Submission, sandbox: Sandbox, limits: Limits) -> None:
        self._submission, self._sandbox, self._limits = submission, sandbox, limits

    @asynccontextmanager
    async def __call__(
        self, folders: Mapping[int, Path], hosted: HostedMatch, addresses: Mapping[int, str], logs: Path
    ) -> AsyncIterator[None]:
        """Run it for as long as the block lasts."""
        agents = MatchAgents(hosted, self._sandbox)
        try:
            for seat in folders:
                token, log = hosted.tokens[seat], logs / LOG
                launch = launch_for(self._submission, addresses[seat], token, log, self._limits, hosted)
                await agents.start(seat, launch)
            yield
            await agents.leave(EXIT_TIME)
        finally:
            await agents.stop()

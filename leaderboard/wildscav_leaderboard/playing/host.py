"""The program of one table: a person's matches against a submission, until one of them leaves.

It reads its order from standard input, and prints a line when it is ready and when it has ended: see
``order.py``.
"""

import asyncio
import signal
import socket
import sys
import time
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from wildscav.errors import WildscavError, describe
from wildscav.system.worker_processes import become_worker
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.matches.agents import MatchAgents
from wildscav_evaluator.matches.play import EXIT_TIME, launch_for
from wildscav_evaluator.model_gateway.gateway import open_gateway
from wildscav_evaluator.model_gateway.settings import ModelSettings
from wildscav_evaluator.sandbox import SANDBOXES, Limits, Sandbox
from wildscav_evaluator.submissions.images import with_images
from wildscav_evaluator.submissions.submission import Submission
from wildscav_leaderboard.conductor.work import chosen_sandbox
from wildscav_leaderboard.playing.order import Order, Told
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.settings import Play, SeasonSettings
from wildscav_leaderboard.submissions.archives import load_archive
from wildscav_server.hosting.hosted_match import HostedMatch
from wildscav_server.hosting.opponents import Opponent
from wildscav_server.monitoring.logs import open_log
from wildscav_stage.playing.links import Base, Links
from wildscav_stage.playing.plan import DEFAULT_MAP, FRAMES_PER_ACTION, Plan
from wildscav_stage.playing.site.serve import Served, prepare, served_on
from wildscav_stage.viewer_files import viewer_file

LOOKS = 0.5  # s between two looks at whether the person is here
COMING = 120.0  # s in which the person must open the page for the first time
AWAY = 20.0  # s for which the page may be closed, such as to load it again
ROBOTS = {"royale": ("fighter-easy",) * 4}  # besides the two, where two alone would be no match
LOG = "agent.log"


def main() -> None:
    """Serve the table that standard input orders; the argument is the id of the parent process."""
    become_worker(int(sys.argv[1]))
    signal.signal(signal.SIGTERM, _stop)
    order = Order.model_validate_json(sys.stdin.read())
    try:
        why = asyncio.run(_serve(order))
    except (OSError, WildscavError) as error:
        return _tell(Told(state="failed", why=describe(error)))
    return _tell(Told(state="ended", why=why))


def _tell(told: Told) -> None:
    print(told.model_dump_json(), flush=True)  # noqa: T201


def _stop(_number: int, _frame: FrameType | None) -> None:
    raise SystemExit(0)


async def _serve(order: Order) -> str:
    """Serve a table until it ends; return why it did."""
    season = Season(Path(order.season), SeasonSettings.model_validate_json(order.settings))
    rules = season.settings.play
    sandbox = SANDBOXES[chosen_sandbox(season, LocalExecutor(1), open_log(None))]
    (submission,) = with_images([load_archive(season, order.archive, order.entrant)], sandbox.name)
    plan = plan_of(order, submission, rules)
    viewer_file("play.js")
    prepare(plan)
    listening = socket.socket(socket.AF_UNIX)
    listening.bind(order.socket)
    listening.listen()
    # From here on the web server takes the signal, and when it has ended, sends it again.
    signal.signal(signal.SIGTERM, lambda *_: None)
    async with served_on(
        listening,
        Base(order.base, order.base),
        Links(rules.people, order.secret),
        plan,
        Path(order.records),
        lambda _: None,
        agents=SandboxedAgents(submission, sandbox, season.limits(order.track), season.settings.model),
        at_home=False,
    ) as served:
        why = await _end(served, rules)
        # The reason goes ahead of the end, so that it is known when the page's connection is lost.
        _tell(Told(state="ended", why=why))
    return why


async def _end(served: Served, rules: Play) -> str:
    """Wait for the end of a table, tell by which code guests come, and return why it ends."""
    lobby = served.table.lobby
    began = acted = here = time.monotonic()
    patience, received, code = COMING, [0], None
    while not served.serving.done():
        if code != lobby.room.code:
            code = lobby.room.code
            _tell(Told(state="ready", code=code))
        await asyncio.wait([served.serving], timeout=LOOKS)
        now = time.monotonic()
        if served.table.is_attended:
            here, patience = now, min(AWAY, rules.idle)
        if (inputs := [player.person.controls.received for player in lobby.seats]) != received:
            acted, received = now, inputs
        if now - here >= patience:
            return "you left"
        if now - acted >= rules.idle:
            return f"you did nothing for {_span(rules.idle)}"
        if now - began >= rules.session:
            return f"your time of {_span(rules.session)} is over"
    return "the season's web server is stopping"


def _span(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 120.0 else f"{seconds / 60.0:.0f} min"


def plan_of(order: Order, submission: Submission, rules: Play) -> Plan:
    """Return the plan of people's matches against a submission, on a map that is drawn for them."""
    robots = ROBOTS.get(order.track, ())
    opponent = Opponent(order.title, submission.folder, submission.sensors)
    spec = MatchSpec(
        track=order.track,
        map=MapSpec(config=DEFAULT_MAP, seed=order.seed),
        seed=order.seed,
        seats=(*(SUBMISSION,) * rules.people, SUBMISSION, *robots),
        time_limit=min(rules.match, TRACKS[order.track].time_limit),
        frames_per_action=FRAMES_PER_ACTION,
    )
    return Plan(spec, (opponent, *map(Opponent, robots)), rules.people)


@dataclass(frozen=True)
class SandboxedAgents:
    """Runs one submission in all seats that are not a person's. See ``playing.rounds.Agents``."""

    submission: Submission  # ready for the sandbox
    sandbox: Sandbox
    limits: Limits
    model: ModelSettings | None = None  # that it may ask

    @asynccontextmanager
    async def __call__(
        self, folders: Mapping[int, Path], hosted: HostedMatch, addresses: Mapping[int, str], logs: Path
    ) -> AsyncIterator[None]:
        """Run it for as long as the block lasts."""
        private = {seat: Path(addresses[seat].removeprefix("unix:")).parent for seat in folders}
        async with open_gateway(self.model, private, None) as model:
            agents = MatchAgents(hosted, self.sandbox, model)
            try:
                log = logs / LOG
                launches = {
                    seat: launch_for(
                        self.submission, addresses[seat], hosted.tokens[seat], log, self.limits, hosted
                    )
                    for seat in folders
                }
                async with agents.started(launches):
                    yield
                    await agents.leave(EXIT_TIME)
            finally:
                await agents.stop()


if __name__ == "__main__":
    main()

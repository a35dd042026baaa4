"""Running a season: the web server and the conductor, each in a process of its own.

Whatever one of them does, the other goes on, and the one that ended is started again. Both end with the
process that started them, however it ends. Before they start, the certificate is checked here.
"""

import multiprocessing
import os
import signal
import ssl
import time
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.process import BaseProcess
from pathlib import Path
from types import FrameType

from wildscav.errors import UserError
from wildscav.system.worker_processes import end_with_parent
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.own_database import opened
from wildscav_leaderboard.seasons.settings import SETTINGS_FILE
from wildscav_server.monitoring.logs import Log, LogFormat, open_log

WEB, CONDUCTOR = "web", "conductor"
LOOKS = 0.2  # s between two looks at the processes
END_TIME = 20.0  # s for a process to end when it is told to
FIRST_PAUSE, LONGEST_PAUSE = 1.0, 60.0  # s before a process that ended is started again
STEADY = 10.0  # s after which a process that ends is no longer one that ends again and again


class Part:
    """One of the processes, which is started again when it ends."""

    def __init__(self, name: str, folder: Path, settings: str, form: LogFormat | None) -> None:
        self.name, self._arguments = name, (name, str(folder), settings, form, os.getpid())
        self._process: BaseProcess | None = None
        self._pause, self._next, self._started = FIRST_PAUSE, 0.0, 0.0

    def keep_running(self, log: Log) -> None:
        """Start the process if it does not run, after a pause that grows if it ends again and again."""
        if self._process is not None and self._process.is_alive():
            return
        moment = time.monotonic()
        if self._process is not None:
            log.warning("process_ended", process=self.name, exit_code=self._process.exitcode)
            pause = FIRST_PAUSE if moment - self._started >= STEADY else self._pause
            self._process, self._next = None, moment + pause
            self._pause = min(2.0 * pause, LONGEST_PAUSE)
        if moment >= self._next:
            context = multiprocessing.get_context("spawn")
            self._process = context.Process(target=run_part, args=self._arguments, name=self.name)
            self._process.start()
            self._started = moment

    def end(self) -> None:
        """Tell the process to end, and kill it if it does not."""
        if self._process is None:
            return
        self._process.terminate()
        self._process.join(END_TIME)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()


def serve(
    season: Season,
    parts: tuple[str, ...] = (WEB, CONDUCTOR),
    form: LogFormat | None = None,
    watch: Callable[[], None] = lambda: None,
) -> None:
    """Run parts of a season until this process is told to end.

    Args:
        season: The season, whose database has the current schema, or is empty.
        parts: ``web``, ``conductor``, or both.
        form: The format of log lines; None writes none.
        watch: Called several times a second; the season ends with what it raises.

    Raises:
        UserError: The database cannot be used.
    """
    with opened(season):
        pass
    log = open_log(form)
    settings = season.settings.model_dump_json()
    running = [Part(name, season.folder, settings, form) for name in parts]
    before = signal.signal(signal.SIGTERM, _interrupt)
    try:
        while True:
            for part in running:
                part.keep_running(log)
            watch()
            time.sleep(LOOKS)
    except KeyboardInterrupt:
        log.info("season_ends")
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        for part in reversed(running):
            part.end()
        signal.signal(signal.SIGTERM, before)


def run_part(name: str, folder: str, settings: str, form: LogFormat | None, parent: int) -> None:
    """Run one part in this process."""
    from wildscav_leaderboard.seasons.settings import SeasonSettings

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent tells this process to end
    end_with_parent(parent)
    season = Season(Path(folder), SeasonSettings.model_validate_json(settings))
    run: dict[str, Callable[[Season, Log], None]] = {WEB: _run_web, CONDUCTOR: _run_conductor}
    run[name](season, open_log(form, process=name))


def _run_web(season: Season, log: Log) -> None:
    from wildscav_leaderboard.hosting.metrics import SeasonMetrics
    from wildscav_leaderboard.hosting.request_log import WebCounts
    from wildscav_leaderboard.hosting.web_server import run_web
    from wildscav_server.monitoring.metrics import serving_metrics
    from wildscav_stage.viewer_files import viewer_addresses

    try:
        viewer_addresses()
    except UserError as error:
        log.warning("matches_not_shown", detail=str(error))
    database, counts = season.database(), WebCounts()
    metrics = SeasonMetrics(season, database, counts)
    try:
        with serving_metrics(metrics, season.settings.web.metrics_port) as address:
            log.info("web_starts", address=season.settings.web.address, metrics=address)
            run_web(season, database, counts, log)
    finally:
        database.close()


def _run_conductor(season: Season, log: Log) -> None:
    from wildscav_leaderboard.conductor.conductor import Conductor

    signal.signal(signal.SIGTERM, _interrupt)
    database = season.database()
    with suppress(KeyboardInterrupt):
        Conductor(season, database, log).run()
    database.close()


def _interrupt(_number: int, _frame: FrameType | None) -> None:
    raise KeyboardInterrupt


def check_certificate(season: Season) -> None:
    """Check the certificate of a season's settings and its key, if they name them.

    Raises:
        UserError: They cannot be read, or do not belong together.
    """
    web = season.settings.web
    if web.certificate is None or web.key is None:
        return
    certificate, key = season.folder / web.certificate, season.folder / web.key
    try:
        ssl.create_default_context(ssl.Purpose.CLIENT_AUTH).load_cert_chain(certificate, key)
    except OSError as error:
        what = f"{certificate} and {key} cannot be used for TLS: {error.strerror or error}"
        raise UserError(f"{season.folder / SETTINGS_FILE}: web.certificate: {what}", exit_code=2) from error

"""In which sandbox a season's agents run. Agents of strangers never run without one by mistake."""

import os

from wildscav.errors import UserError
from wildscav.monitoring.logs import Log
from wildscav_evaluator.executors import Executor
from wildscav_evaluator.sandbox.process import DANGER, WARNING
from wildscav_leaderboard.seasons.folder import Season

VARIABLE = "WILDSCAV_SANDBOX"
WEAK = f"{DANGER}. For code that you do not trust, set sandbox = 'bubblewrap' or 'oci' under [execution]"


def chosen_sandbox(season: Season, executor: Executor, log: Log) -> str:
    """Return the sandbox that the settings or the environment name, else the strongest that works.

    Raises:
        UserError: None that isolates agents works, and the settings do not say to do without.
    """
    asked = season.settings.execution.sandbox or os.environ.get(VARIABLE) or None
    choice, _ = executor.choose_sandbox(asked, [])
    if asked is None and not choice.sandbox.isolated:
        why = "; ".join(choice.warnings[1:])
        raise UserError(
            f"no sandbox works here ({why}): `wildscav doctor` tells more. With sandbox = 'process' in the "
            "settings, agents run without one, which is for agents that you trust"
        )
    for warning in choice.warnings:
        log.warning("sandbox_is_weak", reason=WEAK if warning == WARNING else warning)
    return choice.sandbox.name

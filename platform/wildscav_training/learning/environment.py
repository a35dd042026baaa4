"""The environment of a training run."""

from collections.abc import Mapping, Sequence
from typing import Any

from wildscav.errors import UserError
from wildscav_engine.envs.batched import BatchedArena
from wildscav_training.learning.opposition import fixed_opponents
from wildscav_training.learning.settings import MODES, TrainingSettings, with_opponents

APART = 2**32  # between the seeds of the episodes of two runs
ROOM = 2**20  # seeds for a stage of the curriculum


def make_env(
    settings: TrainingSettings, matches: int, start_range: float | None, **more: Any
) -> BatchedArena:
    """Return the environment of a run.

    Args:
        start_range: The farthest start from the target, m; None: any.
        more: Further options. Without ``opponents`` among them, a run with opposition meets its fixed part.

    Raises:
        UserError: An option is invalid, or the environment is not one that can be learned here.
    """
    options = {"autoreset_mode": "SameStep", **settings.options, **more}
    if settings.opposition is not None:
        if "opponents" not in more:
            options["opponents"] = fixed_opponents(settings.opposition)
        own = int(options.get("agents", 1)) + len(options.get("teammates", ()))
        if len(options.get("teams") or ()) == own:
            options["teams"] = with_opponents(options["teams"], settings.opposition.seats)
    if start_range is not None:
        options["start_range"] = start_range
    try:
        env = BatchedArena(settings.track, matches, **options)
    except (TypeError, ValueError) as error:
        raise UserError(f"the options of the environment: {error}", exit_code=2) from None
    if not env.config.flat or env.config.action_mode not in MODES:
        modes = " or ".join(MODES)
        raise UserError(f"training needs flat=true and action_mode {modes}", exit_code=2)
    return env


def sizes_of(env: BatchedArena) -> tuple[int, ...]:
    """Return the number of choices in each dimension of the action space, (D,)."""
    space: Any = env.single_action_space
    return tuple(space.nvec.tolist()) if hasattr(space, "nvec") else (int(space.n),)


def mean_of(rows: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return the means of numbers by name; without rows nothing."""
    return {name: sum(row[name] for row in rows) / len(rows) for name in rows[0]} if rows else {}

"""What the tests of training share: a run that takes a second."""

from dataclasses import replace
from typing import Any

from tests.engine.envs.common import OPEN

from wildscav_training.learning.settings import Hyperparameters, TrainingSettings

SMALL = Hyperparameters(matches=4, rollout=16, minibatch=16, epochs=2, layers=(8,))
FIELDS = ("curriculum", "seed", "opposition")
OPTIONS: dict[str, Any] = {
    "map": OPEN.model_dump(mode="json"),
    "time_limit": 3.0,
    "flat": True,
    "version": 1,
    "agents": 1,
    "opponents": None,
    "action_mode": "multidiscrete",
}


def small(track: str = "navigation", steps: int = 256, **changes: Any) -> TrainingSettings:
    """The settings of a small run; ``changes`` are fields of the settings, of options or of SMALL."""
    fields = {name: changes.pop(name) for name in FIELDS if name in changes}
    options = {name: changes.pop(name) for name in list(changes) if not hasattr(SMALL, name)}
    return TrainingSettings(
        track=track,
        options={**OPTIONS, **options},
        steps=steps,
        seed=fields.get("seed", 0),
        hyperparameters=replace(SMALL, **changes),
        curriculum=fields.get("curriculum", ()),
        opposition=fields.get("opposition"),
    )

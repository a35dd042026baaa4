"""A trained policy as a submission, which runs with NumPy alone."""

import json
from pathlib import Path
from typing import Any

from wildscav.policy.networks import Choose
from wildscav_training.export import policy_tables, read_model, submission_files
from wildscav_training.learning.checkpoints import WEIGHTS
from wildscav_training.learning.settings import TrainingSettings

TRAINING = "training.json"
# Options that an agent neither sees nor needs.
OF_TRAINING = ("rewards", "threads", "random_maps", "split", "start_range")


def policy_submission(run: Path, settings: TrainingSettings, name: str, choose: Choose) -> dict[str, bytes]:
    """Return the files of a submission that plays the policy of a run, by name.

    Raises:
        UserError: The weights are missing, or do not fit the settings.
    """
    options: dict[str, Any] = {
        name: value for name, value in settings.options.items() if name not in OF_TRAINING
    }
    trained = read_model(run / WEIGHTS)
    files = submission_files(trained, policy_tables(trained, settings.track, options), name, choose)
    return {**files, TRAINING: training_file(settings)}


def training_file(settings: TrainingSettings) -> bytes:
    """Return what a submission holds of its training."""
    return (json.dumps(settings.as_json(), indent=1) + "\n").encode()

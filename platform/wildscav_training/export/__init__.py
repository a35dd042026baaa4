"""Export of trained policies: read models, and make submissions that play them with ``wildscav.policy``.

Only this package needs PyTorch and Stable-Baselines3, and only for models that were saved by them.
"""

from wildscav_training.export.environment_options import policy_tables
from wildscav_training.export.model_files import read_model, submission_files
from wildscav_training.export.trained_model import TrainedModel

__all__ = ["TrainedModel", "policy_tables", "read_model", "submission_files"]

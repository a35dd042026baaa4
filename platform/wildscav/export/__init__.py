"""From a trained policy to a submission: reads models, and writes folders that play with ``wildscav.policy``.

PyTorch and Stable-Baselines3 are needed here alone, for models that come from them.
"""

from wildscav.export.environment_options import fit
from wildscav.export.model_files import read_model
from wildscav.export.submission_folder import submission_files
from wildscav.export.trained_model import Trained

__all__ = ["Trained", "fit", "read_model", "submission_files"]

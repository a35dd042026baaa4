"""From a trained policy to a submission: reads models, and writes folders that play with ``wildscav.policy``.

PyTorch and Stable-Baselines3 are needed here alone, for models that come from them.
"""

from wildscav.export.fitting import fit
from wildscav.export.folder import submission_files
from wildscav.export.reading import read_model
from wildscav.export.trained import Trained

__all__ = ["Trained", "fit", "read_model", "submission_files"]

"""The old name of ``wildscav_training.opponents``, for one release."""

import importlib
import warnings
from typing import Any

NEW_NAME = "wildscav_training.opponents"


def __getattr__(name: str) -> Any:
    """Return what has moved, with a warning."""
    warnings.warn(f"wildscav.opponents is called {NEW_NAME} now", DeprecationWarning, stacklevel=2)
    return getattr(importlib.import_module(NEW_NAME), name)

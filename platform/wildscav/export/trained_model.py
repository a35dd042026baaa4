"""A model as it comes out of training, whatever kind of file it was read from."""

import io
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Shape = tuple[int, ...]
LAYERS_FILE, ONNX_FILE = "network.npz", "network.onnx"
ONNX_REQUIREMENT = "onnxruntime>=1.20"


@dataclass(frozen=True)
class Trained:
    """A model: what it takes, what it gives, and the files that hold it."""

    source: Path
    inputs: Mapping[str, Shape] | Shape  # of one observation, by name or as one array
    outputs: int | None  # how many numbers it gives; None: not told
    head: str | None  # what they mean, as in ``wildscav.policy.action_choice``; None: told by their number
    sizes: Shape = ()  # how many things it chooses from in each place, where that is told
    whole: bool = False  # whether the outputs are whole numbers: the choice itself
    network: Mapping[str, Any] = field(default_factory=dict)  # the table "network" of policy.json
    files: Mapping[str, bytes] = field(default_factory=dict)  # by name
    requirements: tuple[str, ...] = ()  # lines of requirements.txt


def pack_layers(weights: list[NDArray[Any]], biases: list[NDArray[Any]]) -> bytes:
    """Return the file of layers that ``read_layers`` reads."""
    arrays = {f"weight_{layer}": np.asarray(weight, np.float32) for layer, weight in enumerate(weights)}
    arrays |= {f"bias_{layer}": np.asarray(bias, np.float32) for layer, bias in enumerate(biases)}
    file = io.BytesIO()
    np.savez(file, **arrays)  # type: ignore[arg-type]
    return file.getvalue()

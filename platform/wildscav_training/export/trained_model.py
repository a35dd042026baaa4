"""A trained model, independent of the kind of file it was read from."""

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
class TrainedModel:
    """A model: its inputs, its outputs, and the files that contain it."""

    source: Path
    inputs: Mapping[str, Shape] | Shape  # shapes of one observation, by name or as one array
    outputs: int | None  # how many numbers it returns; None if the file does not specify it
    head: (
        str | None
    )  # their meaning, as in ``wildscav.policy.action_choice``; None: inferred from their number
    sizes: Shape = ()  # the number of choices in each dimension of the action space, where it is known
    outputs_are_integers: bool = False  # whether the outputs are integers, which are the choice itself
    network: Mapping[str, Any] = field(default_factory=dict)  # the table "network" of policy.json
    files: Mapping[str, bytes] = field(default_factory=dict)  # by name
    requirements: tuple[str, ...] = ()  # lines of requirements.txt


def pack_layers(weights: list[NDArray[Any]], biases: list[NDArray[Any]]) -> bytes:
    """Return the content of a file of layers, as ``read_layers`` reads it."""
    arrays = {f"weight_{layer}": np.asarray(weight, np.float32) for layer, weight in enumerate(weights)}
    arrays |= {f"bias_{layer}": np.asarray(bias, np.float32) for layer, bias in enumerate(biases)}
    file = io.BytesIO()
    np.savez(file, **arrays)  # type: ignore[arg-type]
    return file.getvalue()

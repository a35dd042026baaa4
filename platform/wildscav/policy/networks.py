"""The networks of policies: fully connected layers in NumPy, or ONNX models in ONNX Runtime."""

import math
import zipfile
from collections.abc import Callable, Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from wildscav.policy.errors import PolicyError
from wildscav.policy.observation_stack import Stacked

Numbers = NDArray[np.float32]

NEEDED = "its arrays must be weight_0, bias_0, weight_1 and so on"


class Choose(StrEnum):
    """How a policy chooses by its network's outputs."""

    SAMPLED = "sampled"  # at random, with the network's probabilities
    DETERMINISTIC = "deterministic"  # always the likeliest choice


class Network(Protocol):
    """A function from an observation to outputs."""

    def __call__(self, observation: Stacked) -> NDArray[Any]:
        """Return (n,) the outputs for one observation."""
        ...


ACTIVATIONS: dict[str, Callable[[NDArray[Any]], NDArray[Any]]] = {
    "identity": lambda x: x,
    "tanh": np.tanh,
    "relu": lambda x: np.maximum(x, np.float32(0.0)),
    "elu": lambda x: np.where(x > 0.0, x, np.expm1(np.minimum(x, np.float32(0.0)))),
    "leaky_relu": lambda x: np.maximum(x, np.float32(0.01) * x),
    "silu": lambda x: x / (np.float32(1.0) + np.exp(-x)),
}


class Layers:
    """A sequence of fully connected layers in float32.

    Args:
        weights: (outputs, inputs) for each layer.
        biases: (outputs,) for each layer.
        activations: The name of the activation after each layer, a key of ``ACTIVATIONS``.

    Raises:
        PolicyError: They do not fit one another.
    """

    def __init__(
        self, weights: Sequence[NDArray[Any]], biases: Sequence[NDArray[Any]], activations: Sequence[str]
    ) -> None:
        if not weights or not len(weights) == len(biases) == len(activations):
            raise PolicyError("the network needs a weight, a bias and an activation for each of its layers")
        for layer, (weight, bias) in enumerate(zip(weights, biases, strict=True)):
            inputs = weight.shape[-1] if layer == 0 else weights[layer - 1].shape[0]
            if weight.ndim != 2 or weight.shape[1] != inputs or bias.shape != weight.shape[:1]:
                raise PolicyError(
                    f"layer {layer} of the network has weights {weight.shape} and biases {bias.shape}; "
                    f"they must be (outputs, {inputs}) and (outputs,)"
                )
            if not (np.isfinite(weight).all() and np.isfinite(bias).all()):
                raise PolicyError(f"layer {layer} of the network has numbers that are not finite")
        if unknown := sorted(set(activations) - set(ACTIVATIONS)):
            raise PolicyError(
                f"the network has the activation {unknown[0]!r}, must be one of {', '.join(ACTIVATIONS)}"
            )
        self.inputs, self.outputs = weights[0].shape[1], weights[-1].shape[0]
        self._layers = [
            (weight.astype(np.float32), bias.astype(np.float32), ACTIVATIONS[name])
            for weight, bias, name in zip(weights, biases, activations, strict=True)
        ]

    def __call__(self, observation: Stacked) -> Numbers:
        """Return (outputs,) for one observation, whose parts are concatenated in order."""
        values = in_one_row(observation)
        for weight, bias, activate in self._layers:
            values = activate(weight @ values + bias)
        return values


class OnnxNetwork:
    """A network in ONNX Runtime.

    Its inputs are the observation, or parts of it by name, each with a leading batch axis.
    """

    def __init__(self, path: Path) -> None:
        """Load a file, or raise a PolicyError if ONNX Runtime is not installed or cannot load it."""
        try:
            import onnxruntime
        except ImportError:
            raise PolicyError(
                f"{path.name} needs ONNX Runtime: pip install onnxruntime "
                "(`wildscav build` installs what requirements.txt names)"
            ) from None
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = options.inter_op_num_threads = 1
        try:
            self._session = onnxruntime.InferenceSession(str(path), options, ["CPUExecutionProvider"])
        except Exception as error:  # ONNX Runtime's errors have no common base
            raise PolicyError(f"ONNX Runtime cannot load {path}: {error}") from error
        inputs, output = self._session.get_inputs(), self._session.get_outputs()[0]
        self._dtypes = {one.name: _numpy_type(one.type) for one in inputs}
        self.shapes = {one.name: _shape_of_one(one.shape) for one in inputs}  # of one observation; None: any
        shape = _shape_of_one(output.shape)
        # How many numbers it returns; None if the file does not specify it.
        self.outputs = None if shape is None else math.prod(shape)
        self.outputs_are_integers = _numpy_type(output.type).kind in "iu"  # whether they are integers

    def __call__(self, observation: Stacked) -> NDArray[Any]:
        """Return (n,) the network's first output for one observation."""
        inputs = self._inputs(observation)
        feeds = {name: values.astype(self._dtypes[name])[np.newaxis] for name, values in inputs.items()}
        try:
            outputs = self._session.run(None, feeds)
        except Exception as error:
            shapes = ", ".join(f"{name} {values.shape}" for name, values in feeds.items())
            raise PolicyError(f"the ONNX network does not accept {shapes}: {error}") from error
        return np.asarray(outputs[0]).reshape(-1)

    def _inputs(self, observation: Stacked) -> Mapping[str, NDArray[Any]]:
        if isinstance(observation, Mapping) and set(self._dtypes) <= set(observation):
            return {name: observation[name] for name in self._dtypes}
        if len(self._dtypes) != 1:
            parts = ", ".join(observation) if isinstance(observation, Mapping) else "one row"
            raise PolicyError(
                f"the ONNX network takes {', '.join(self._dtypes)}; the observation has {parts}"
            )
        return {name: in_one_row(observation) for name in self._dtypes}


def in_one_row(observation: Stacked) -> Numbers:
    """Return (n,) all numbers of an observation, its parts concatenated."""
    if isinstance(observation, Mapping):
        parts = [values.reshape(-1) for values in observation.values()]
        return np.concatenate(parts, dtype=np.float32)
    return observation.reshape(-1).astype(np.float32, copy=False)


def _numpy_type(name: str) -> "np.dtype[Any]":
    """Return the NumPy type for ONNX Runtime's name of a type, such as "tensor(float)"."""
    inner = name.removeprefix("tensor(").removesuffix(")")
    try:
        return np.dtype({"float": "float32", "double": "float64"}.get(inner, inner))
    except TypeError:
        raise PolicyError(f"the ONNX network has the type {name}, must be numbers") from None


def _shape_of_one(shape: Sequence[Any]) -> tuple[int, ...] | None:
    """Return a shape without its batch axis, the first; None if another axis may have any length."""
    lengths = tuple(shape[1:])
    return lengths if all(isinstance(length, int) and length > 0 for length in lengths) else None


def load_network(folder: Path, description: Mapping[str, Any]) -> Network:
    """Return the network that a ``policy.json`` names, or raise a PolicyError if it cannot be loaded."""
    kind, path = description.get("kind"), folder / str(description.get("file"))
    if not path.is_file():
        raise PolicyError(f"{path} is missing: policy.json names it as its network")
    if kind == "onnx":
        return OnnxNetwork(path)
    if kind == "layers":
        weights, biases = read_layers(path)
        activations = description.get("activations")
        if not isinstance(activations, list) or not all(isinstance(name, str) for name in activations):
            raise PolicyError(f"policy.json: activations is {activations!r}, must be a list of names")
        return Layers(weights, biases, activations)
    raise PolicyError(f"policy.json has a network of kind {kind!r}; the kinds are layers, onnx")


def read_layers(path: Path) -> tuple[list[NDArray[Any]], list[NDArray[Any]]]:
    """Return the weights and biases in a file of arrays ``weight_0``, ``bias_0``, ``weight_1`` and so on.

    Raises:
        PolicyError: It is not such a file.
    """
    try:
        with np.load(path, allow_pickle=False) as arrays:
            names = [f"weight_{layer}" for layer in range(len(arrays.files))]
            count = next((layer for layer, name in enumerate(names) if name not in arrays), len(names))
            weights = [arrays[f"weight_{layer}"] for layer in range(count)]
            biases = [arrays[f"bias_{layer}"] for layer in range(count)]
    except (KeyError, TypeError, ValueError, OSError, EOFError, zipfile.BadZipFile) as error:
        raise PolicyError(f"{path} holds no layers: {error}; {NEEDED}") from None
    if not weights:
        raise PolicyError(f"{path} holds no weight_0; {NEEDED}")
    if () in (weight.shape for weight in weights):
        raise PolicyError(f"{path} holds no layers: a weight is a single number; {NEEDED}")
    if strange := [values.dtype for values in (*weights, *biases) if values.dtype.kind not in "fiu"]:
        raise PolicyError(f"{path} holds {strange[0]}, must hold numbers")
    return weights, biases

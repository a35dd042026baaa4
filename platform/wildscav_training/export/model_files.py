"""Reading models from files, by their suffix."""

import json
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav.errors import UserError
from wildscav.policy.errors import PolicyError
from wildscav.policy.networks import ACTIVATIONS, Choose, Layers, OnnxNetwork, read_layers
from wildscav.policy.policy import FILE
from wildscav_training.export.stable_baselines import read_zip
from wildscav_training.export.trained_model import (
    LAYERS_FILE,
    ONNX_FILE,
    ONNX_REQUIREMENT,
    TrainedModel,
    pack_layers,
)

SUFFIXES = (".zip", ".onnx", ".npz")
TEMPLATE = ("agent.py", "README.md")


def read_model(path: Path, activation: str = "tanh") -> TrainedModel:
    """Read a model: a zip of Stable-Baselines3, an ONNX file, or an npz of layers.

    Args:
        path: The file. A zip contains Python objects, so read only one that you trust.
        activation: The activation after each layer but the last, for an npz file.

    Raises:
        UserError: It cannot be read, or needs a library that is not installed.
    """
    if not path.is_file():
        raise UserError(f"{path} is not a file: give the file of a saved model", exit_code=2)
    try:
        if path.suffix == ".npz":
            return _read_npz(path, activation)
        if path.suffix == ".onnx":
            return _read_onnx(path)
        if path.suffix == ".zip":
            return read_zip(path)
    except PolicyError as error:
        raise UserError(f"{path}: {error}", exit_code=2) from None
    raise UserError(
        f"{path} ends in {path.suffix or 'nothing'}; models end in {', '.join(SUFFIXES)}", exit_code=2
    )


def _read_npz(path: Path, activation: str) -> TrainedModel:
    if activation not in ACTIVATIONS:
        raise UserError(
            f"--activation is {activation!r}, must be one of {', '.join(ACTIVATIONS)}", exit_code=2
        )
    weights, biases = read_layers(path)
    activations = [activation] * (len(weights) - 1) + ["identity"]
    layers = Layers(weights, biases, activations)
    network: dict[str, Any] = {"kind": "layers", "file": LAYERS_FILE, "activations": activations}
    with np.load(path, allow_pickle=False) as arrays:
        if "log_std" in arrays:
            network["deviations"] = _deviations(path, arrays["log_std"])
    return TrainedModel(
        source=path,
        inputs=(layers.inputs,),
        outputs=layers.outputs,
        head=None,
        network=network,
        files={LAYERS_FILE: pack_layers(weights, biases)},
    )


def _deviations(path: Path, logs: NDArray[Any]) -> list[float]:
    """Return the standard deviations with the given logarithms."""
    if logs.dtype.kind not in "fiu":
        raise UserError(f"{path}: log_std holds {logs.dtype}, must hold numbers", exit_code=2)
    deviations: list[float] = np.exp(logs.astype(np.float64)).reshape(-1).tolist()
    return deviations


def _read_onnx(path: Path) -> TrainedModel:
    network = OnnxNetwork(path)
    shapes = {name: shape for name, shape in network.shapes.items() if shape is not None}
    if len(shapes) < len(network.shapes):
        unknown = next(name for name, shape in network.shapes.items() if shape is None)
        raise UserError(f"{path}: the input {unknown} must have a fixed shape, except for its batch axis", 2)
    return TrainedModel(
        source=path,
        inputs=shapes if len(shapes) > 1 else next(iter(shapes.values())),
        outputs=network.outputs,
        head=None,
        outputs_are_integers=network.outputs_are_integers,
        network={"kind": "onnx", "file": ONNX_FILE},
        files={ONNX_FILE: path.read_bytes()},
        requirements=(ONNX_REQUIREMENT,),
    )


def submission_files(
    trained: TrainedModel, tables: Mapping[str, Any], name: str, choose: Choose
) -> dict[str, bytes]:
    """Return the files of a submission, from what ``policy_tables`` returned: their contents by name."""
    policy = {"choose": choose.value, "network": tables["network"], "environment": tables["environment"]}
    template = files("wildscav_training.export") / "template"
    texts = {file: (template / file).read_text("utf-8") for file in TEMPLATE}
    written = {
        "submission.toml": _manifest(tables["environment"], name),
        FILE: json.dumps(policy, indent=1) + "\n",
        **{file: text.replace("my-agent", name) for file, text in texts.items()},
    }
    if trained.requirements:
        written["requirements.txt"] = "".join(f"{line}\n" for line in trained.requirements)
    return {**{file: text.encode() for file, text in written.items()}, **trained.files}


def _manifest(environment: Mapping[str, Any], name: str) -> str:
    lines = [
        f"name = {json.dumps(name)}",
        'version = "0.1.0"',
        'entry_point = "agent:TrainedAgent"',
        f"tracks = [{json.dumps(environment['track'])}]",
    ]
    for part in environment["observations"]:
        if "sensor" in part:
            # Numbers, strings, booleans and lists of them are written in TOML as in JSON.
            options = {key: value for key, value in part["sensor"].items() if value is not None}
            lines += ["", f"[sensors.{part['name']}]"]
            lines += [f"{key} = {json.dumps(value)}" for key, value in options.items()]
    return "\n".join(lines) + "\n"

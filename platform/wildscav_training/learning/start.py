"""What a policy begins with, where it does not begin with nothing: the weights of another one."""

from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav.errors import UserError, describe
from wildscav.policy.errors import PolicyError
from wildscav.policy.networks import read_layers

Layers = tuple[list[NDArray[Any]], list[NDArray[Any]]]  # weights (outputs, inputs) and biases (outputs,)


@dataclass(frozen=True)
class Start:
    """A file of weights, such as the ``policy.npz`` of another run."""

    path: Path
    digest: str  # of the file; a run with other weights is another run

    def as_json(self) -> str:
        """Return it as a value for JSON: the digest alone, since the file may lie anywhere."""
        return self.digest

    def layers(self) -> Layers:
        """Return the weights and biases of its layers, or raise a UserError if the file has none."""
        try:
            return read_layers(self.path)
        except PolicyError as error:
            raise UserError(f"--start-from: {error}", exit_code=2) from None


def read_start(path: Path) -> Start:
    """Return the start that a command names, or raise a UserError if the file is missing or not of layers."""
    try:
        digest = blake2b(path.read_bytes(), digest_size=16).hexdigest()
    except OSError as error:
        raise UserError(f"--start-from: {describe(error)}", exit_code=2) from None
    start = Start(path, digest)
    start.layers()
    return start


def put_layers(layers: Layers, network: Any) -> None:
    """Copy layers into the modules of a PyTorch network that have weights; a UserError if it has others."""
    import torch

    linear = [module for module in network if hasattr(module, "weight")]
    wanted, found = [tuple(module.weight.shape) for module in linear], [array.shape for array in layers[0]]
    if wanted != found:
        raise UserError(
            f"--start-from has layers {_listed(found)} and this run {_listed(wanted)} (outputs × inputs): it "
            "must have the same observations, actions and layers",
            exit_code=2,
        )
    with torch.no_grad():
        for module, weight, bias in zip(linear, *layers, strict=True):
            module.weight.copy_(torch.from_numpy(weight.astype(np.float32)))
            module.bias.copy_(torch.from_numpy(bias.astype(np.float32)))


def _listed(shapes: list[tuple[int, ...]]) -> str:
    return ", ".join(" × ".join(map(str, shape)) for shape in shapes)

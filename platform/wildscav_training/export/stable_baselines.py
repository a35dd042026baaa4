"""Models of Stable-Baselines3. Fully connected networks are exported as layers, all others as ONNX."""

import io
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from wildscav.errors import UserError
from wildscav.policy.action_choice import NUMBERS, SCORES, SQUASHED, VALUES
from wildscav_training.export.trained_model import (
    LAYERS_FILE,
    ONNX_FILE,
    ONNX_REQUIREMENT,
    Shape,
    TrainedModel,
    pack_layers,
)

# PyTorch's activations by class name.
ACTIVATIONS = {"Tanh": "tanh", "ReLU": "relu", "ELU": "elu", "LeakyReLU": "leaky_relu", "SiLU": "silu"}
# Modules that have no effect when a policy plays.
NO_EFFECT = ("Flatten", "Dropout", "Identity", "FlattenExtractor")


class NotLayersError(Exception):
    """A network does not consist of fully connected layers alone."""


def read_zip(path: Path) -> TrainedModel:
    """Read a file that ``model.save`` wrote, on the CPU.

    Raises:
        UserError: It is not such a file, Stable-Baselines3 is not installed, or its policy cannot be
            exported.
    """
    try:
        from stable_baselines3.common.save_util import load_from_zip_file
    except ImportError:
        raise UserError(
            f"reading {path} needs Stable-Baselines3: pip install 'wildscav[training]'", exit_code=2
        ) from None
    try:
        data, parameters, _ = load_from_zip_file(path, device="cpu")
        policy = _policy_of(data or {}, parameters)
    except UserError:
        raise
    except Exception as error:  # noqa: BLE001 - a damaged or foreign zip can raise anything
        raise UserError(f"{path} is not a model of Stable-Baselines3: {error}", exit_code=2) from None
    return _trained(path, policy)


def _policy_of(data: Mapping[str, Any], parameters: Mapping[str, Any]) -> Any:
    """Return the policy. It is constructed without its environment and algorithm, which are not needed."""
    kind = data["policy_class"]
    options = dict(data.get("policy_kwargs", {}))
    if data.get("use_sde"):
        raise UserError("a policy with state-dependent exploration (use_sde) cannot be exported", exit_code=2)
    if "Recurrent" in kind.__name__:
        raise UserError(f"{kind.__name__} is recurrent: such policies cannot be exported", exit_code=2)
    policy = kind(data["observation_space"], data["action_space"], lambda _: 0.0, **options)
    policy.load_state_dict(parameters["policy"])
    policy.set_training_mode(False)
    return policy


def _trained(path: Path, policy: Any) -> TrainedModel:
    modules, head, deviations = _parts(policy)
    network: dict[str, Any] = {} if deviations is None else {"deviations": deviations}
    common: dict[str, Any] = {
        "source": path,
        "inputs": _shapes(policy.observation_space),
        "outputs": None,
        "head": head,
        "sizes": _sizes(policy.action_space),
    }
    try:
        if any(map(_is_picture, _spaces(policy).values())):
            raise NotLayersError  # Stable-Baselines3 first scales the pixels of images
        weights, biases, activations = _layers(modules)
    except NotLayersError:
        files = {ONNX_FILE: _onnx(policy)}
        network |= {"kind": "onnx", "file": ONNX_FILE}
        return TrainedModel(**common, network=network, files=files, requirements=(ONNX_REQUIREMENT,))
    network |= {"kind": "layers", "file": LAYERS_FILE, "activations": activations}
    return TrainedModel(**common, network=network, files={LAYERS_FILE: pack_layers(weights, biases)})


def _parts(policy: Any) -> tuple[list[Any], str, list[float] | None]:
    """Return the modules of a policy in order, the meaning of their outputs, and deviations if any."""
    numbers = not _sizes(policy.action_space)
    if hasattr(policy, "mlp_extractor"):  # PPO, A2C
        modules = [policy.pi_features_extractor, policy.mlp_extractor.policy_net, policy.action_net]
        if numbers:
            return modules, NUMBERS, np.exp(policy.log_std.detach().numpy().astype(np.float64)).tolist()
        return modules, SCORES, None
    if hasattr(policy, "q_net"):  # DQN
        return [policy.q_net.features_extractor, policy.q_net.q_net], VALUES, None
    actor: Any = getattr(policy, "actor", None)
    if hasattr(actor, "latent_pi"):  # SAC
        return [actor.features_extractor, actor.latent_pi, (actor.mu, actor.log_std)], SQUASHED, None
    if hasattr(actor, "mu"):  # TD3, DDPG
        return [actor.features_extractor, actor.mu], NUMBERS, None
    raise UserError(f"policies of the kind {type(policy).__name__} cannot be exported", exit_code=2)


def _layers(modules: list[Any]) -> tuple[list[Any], list[Any], list[str]]:
    """Return the weights, biases and activations of a sequence of modules."""
    weights: list[Any] = []
    biases: list[Any] = []
    activations: list[str] = []
    for module in modules:
        for part in _leaves(module):
            name = type(part[0]).__name__
            if name == "Linear":
                weights.append(np.concatenate([one.weight.detach().numpy() for one in part]))
                biases.append(np.concatenate([one.bias.detach().numpy() for one in part]))
                activations.append("identity")
            elif name in ACTIVATIONS and activations and activations[-1] == "identity":
                if name == "LeakyReLU" and part[0].negative_slope != 0.01:
                    raise NotLayersError
                activations[-1] = ACTIVATIONS[name]
            elif name not in NO_EFFECT:
                raise NotLayersError
    return weights, biases, activations


def _leaves(module: Any) -> Iterator[tuple[Any, ...]]:
    """Yield the modules inside a module, in order; those in one tuple are parallel."""
    if isinstance(module, tuple):
        yield module
    elif type(module).__name__ == "Sequential":
        for inner in module:
            yield from _leaves(inner)
    elif type(module).__name__ == "CombinedExtractor":
        for inner in module.extractors.values():  # layers only if each of them just flattens
            yield from _leaves(inner)
    else:
        yield (module,)


def _shapes(space: Any) -> Mapping[str, Shape] | Shape:
    """Return the shape of an observation as the environment returns it: images with their channels last."""
    if hasattr(space, "spaces"):
        return {name: _shape(inner) for name, inner in space.spaces.items()}
    return _shape(space)


def _shape(space: Any) -> Shape:
    shape: Shape = tuple(space.shape)
    return (*shape[1:], shape[0]) if _is_transposed(space) else shape


def _spaces(policy: Any) -> dict[str, Any]:
    """Return the spaces of a policy's observations, by name."""
    space = policy.observation_space
    return dict(space.spaces) if hasattr(space, "spaces") else {"observation": space}


def _is_picture(space: Any) -> bool:
    from stable_baselines3.common.preprocessing import is_image_space

    return bool(is_image_space(space))


def _is_transposed(space: Any) -> bool:
    """Return whether Stable-Baselines3 has moved the channels of an image to the front."""
    from stable_baselines3.common.preprocessing import is_image_space_channels_first

    return _is_picture(space) and bool(is_image_space_channels_first(space))


def _sizes(space: Any) -> Shape:
    """Return the number of choices in each dimension of an action space; () for a continuous one."""
    if hasattr(space, "nvec"):
        return tuple(space.nvec.tolist())
    return (int(space.n),) if hasattr(space, "n") else ()


def _onnx(policy: Any) -> bytes:
    """Return a policy as ONNX: from observations, as the environment returns them, to its outputs."""
    import torch

    spaces = _spaces(policy)
    given = tuple(
        torch.zeros(1, *_shape(inner), dtype=torch.as_tensor(np.zeros(1, inner.dtype)).dtype)
        for inner in spaces.values()
    )
    module, names = _outputs_of(policy), list(spaces)
    file = io.BytesIO()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the exporter itself causes some
            torch.onnx.export(module, given, file, input_names=names, output_names=["outputs"], dynamo=False)
    except Exception as error:  # noqa: BLE001 - the exporter's errors have many bases
        raise UserError(
            f"the policy has other than fully connected layers, and PyTorch cannot write it as ONNX: {error} "
            "(pip install onnx)",
            exit_code=2,
        ) from None
    return file.getvalue()


def _outputs_of(policy: Any) -> Any:
    """Return a module that maps an observation's arrays, as the environment returns them, to outputs."""
    import torch

    spaces = _spaces(policy)

    class Outputs(torch.nn.Module):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__()
            self.policy = policy

        def forward(self, *arrays: Any) -> Any:
            parts = {
                name: array.permute(0, 3, 1, 2) if _is_transposed(inner) else array
                for (name, inner), array in zip(spaces.items(), arrays, strict=True)
            }
            is_single = not hasattr(policy.observation_space, "spaces")
            return _forward(self.policy, parts["observation"] if is_single else parts)

    return Outputs()


def _forward(policy: Any, observation: Any) -> Any:
    import torch

    if hasattr(policy, "mlp_extractor"):
        features = policy.extract_features(observation, policy.pi_features_extractor)
        return policy.action_net(policy.mlp_extractor.forward_actor(features))
    if hasattr(policy, "q_net"):
        return policy.q_net(observation)
    actor = policy.actor
    features = actor.extract_features(observation, actor.features_extractor)
    if hasattr(actor, "latent_pi"):
        latent = actor.latent_pi(features)
        return torch.cat([actor.mu(latent), actor.log_std(latent)], dim=1)
    return actor.mu(features)

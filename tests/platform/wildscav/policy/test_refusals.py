"""What a policy's file may be, and what it is told when it is something else."""

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.platform.wildscav.skills.observations import match_info, seen

from wildscav.policy import Environment, Policy
from wildscav.policy.action_choice import Chooser
from wildscav.policy.action_modes import action_mode
from wildscav.policy.errors import PolicyError
from wildscav.policy.networks import Choose, Layers, OnnxNetwork, read_layers

CHOICES = {
    "mode": "multidiscrete",
    "directions": [None, 0.0, 90.0],
    "speeds": [5.0],
    "turns": [-9.0, 9.0],
    "looks": [0.0],
    "flags": ["jump"],
}
BOX = {"mode": "box", "walk_speed": 10.0, "turn": 9.0, "look": 4.0, "flags": ["jump"]}
KEYS = {"mode": "keys", "flags": ["jump"], "most": 9000, "frames": 5}
HELD = dict.fromkeys(("forward", "back", "left", "right", "mouse_x", "mouse_y", "jump"), 0)
BODY = {
    "name": "body",
    "shape": [3],
    "dtype": "<f4",
    "scale": 1.0,
    "columns": ["alive", "on_ground", "in_water"],
}
DEPTH = {
    "name": "depth",
    "shape": [2, 2],
    "dtype": "<f4",
    "scale": 100.0,
    "sensor": {"width": 2, "height": 2},
}
DESCRIPTION: dict[str, Any] = {
    "format": 1,
    "track": "navigation",
    "frames_per_action": 5,
    "flat": True,
    "observations": [BODY, DEPTH],
    "actions": CHOICES,
}


def changed(**changes: Any) -> dict[str, Any]:
    return copy.deepcopy(DESCRIPTION) | changes


@pytest.mark.parametrize(
    ("description", "message"),
    [
        (changed(format=2), "has format 2; this version reads 1"),
        (changed(observations=[BODY | {"columns": ["hungry"]}]), "needs 'hungry' of 'body', which this"),
        (changed(observations=[BODY | {"name": "mood"}]), "needs 'alive' of 'mood'"),
        (changed(actions={"mode": "voice"}), "action mode 'voice'; those known here are dict, box"),
        ({"format": 1}, "the environment's description is invalid: KeyError"),
        (changed(stack={"count": 0, "axis": "last", "padding": "zero"}), "invalid: .*a stack of 0 along"),
        (changed(stack={"count": 2, "axis": "up", "padding": "zero"}), "invalid: .*along axis 'up'"),
        (changed(observations=["body"]), "invalid: TypeError"),
        (changed(actions=["dict"]), "invalid: AttributeError"),
    ],
)
def test_a_description_that_cannot_be_read_is_refused(description: dict[str, Any], message: str) -> None:
    with pytest.raises(PolicyError, match=message):
        Environment(description)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"track": "battle"}, "trained for the track navigation; this is battle"),
        ({"frames_per_action": 3}, "trained with 5 frames per action, which is not a multiple of the 3 of"),
    ],
)
def test_a_match_that_does_not_fit_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(PolicyError, match=message):
        Environment(DESCRIPTION).begin(match_info(**{"track": "navigation"} | changes))


def test_a_sensor_that_arrives_otherwise_than_in_training_is_named() -> None:
    environment = Environment(DESCRIPTION)
    environment.begin(match_info(track="navigation"))
    with pytest.raises(
        PolicyError, match=r"the sensor depth returns float32 \(3, 2\).*fix \[sensors.depth\]"
    ):
        environment.observe(seen(tensors={"depth": np.zeros((3, 2), np.float32)}))
    row = environment.observe(seen(tensors={"depth": np.full((2, 2), 50.0, np.float32)}))
    assert row.tolist() == [1, 1, 0, 0.5, 0.5, 0.5, 0.5]


@pytest.mark.parametrize(
    ("actions", "choice", "message"),
    [
        (CHOICES, [0, 0, 2, 0, 0], r"choice is \[0, 0, 2, 0, 0\], must be at least 0 and below \[3, 1, 2"),
        (CHOICES, [0.0] * 5, "must be 5 whole numbers"),
        (CHOICES, [0, 0, 0], "must be 5 whole numbers"),
        (BOX, [0.0, 0.0, np.nan, 0.0, 0.0], r"must be 5 numbers in \[-1, 1\]"),
        ({"mode": "dict", "fields": ["jump"]}, {"fly": 1}, "must be a mapping of jump"),
        (KEYS, {"forward": 1}, "must be a mapping of forward, back, left, right, mouse_x, mouse_y, jump"),
        (KEYS, HELD | {"jump": 2}, "jump is 2, must be 0 or 1"),
        (KEYS, HELD | {"mouse_x": np.nan}, "mouse_x is nan, must be from -9000 to 9000"),
    ],
)
def test_a_choice_outside_the_action_space_is_refused(actions: Any, choice: Any, message: str) -> None:
    with pytest.raises(PolicyError, match=message):
        action_mode(actions).action(choice, 0.0)


def test_the_likeliest_is_chosen_or_each_as_likely_as_the_network_says() -> None:
    mode, random = action_mode(CHOICES), np.random.default_rng(0)
    scores = np.log([0.2, 0.5, 0.3, 1.0, 0.9, 0.1, 1.0, 0.25, 0.75]).astype(np.float32)
    assert Chooser(mode, "scores", Choose.DETERMINISTIC)(scores, random).tolist() == [1, 0, 0, 0, 1]
    sampled = Chooser(mode, "scores", Choose.SAMPLED)
    drawn = np.array([sampled(scores, random) for _ in range(4000)])
    shares = [np.bincount(drawn[:, place], minlength=2) / 4000 for place in range(5)]
    for share, wanted in zip(
        shares, ([0.2, 0.5, 0.3], [1, 0], [0.9, 0.1], [1, 0], [0.25, 0.75]), strict=True
    ):
        np.testing.assert_allclose(share, wanted, atol=0.03)


def test_numbers_are_drawn_around_the_mean_and_stay_in_their_range() -> None:
    mode, random = action_mode(BOX), np.random.default_rng(0)
    means, deviations = np.array([0.5, -0.5, 0.0, 5.0, 0.0], np.float32), np.array([0.1, 0.2, 0.0, 0.0, 0.0])
    assert Chooser(mode, "numbers", Choose.DETERMINISTIC)(means, random).tolist() == [0.5, -0.5, 0, 1, 0]
    sampled = Chooser(mode, "numbers", Choose.SAMPLED, deviations)
    drawn = np.array([sampled(means, random) for _ in range(4000)])
    np.testing.assert_allclose(drawn.std(axis=0), deviations, atol=0.01)
    squashed = np.concatenate([means, np.full(5, -3.0, np.float32)])
    chosen = Chooser(mode, "squashed", Choose.DETERMINISTIC)(squashed, random)
    np.testing.assert_array_equal(chosen, np.tanh(means))
    assert np.std([Chooser(mode, "squashed", Choose.SAMPLED)(squashed, random)[2] for _ in range(200)]) > 0.03


@pytest.mark.parametrize("outputs", [np.zeros(8, np.float32), np.full(9, np.nan, np.float32)])
def test_outputs_that_are_no_scores_are_refused(outputs: Any) -> None:
    with pytest.raises(PolicyError, match="must be 9 finite numbers"):
        Chooser(action_mode(CHOICES), "scores", Choose.SAMPLED)(outputs, np.random.default_rng(0))


@pytest.mark.parametrize("head", ["numbers", "squashed", "values", "guess"])
def test_a_head_that_does_not_fit_the_action_mode_is_refused(head: str) -> None:
    with pytest.raises(PolicyError, match=f"the head '{head}'"):
        Chooser(action_mode(CHOICES), head, Choose.SAMPLED)


def test_layers_have_to_fit_one_another() -> None:
    weights = [np.ones((4, 7), np.float32), np.ones((2, 3), np.float32)]
    with pytest.raises(
        PolicyError, match=r"layer 1 of the network has weights \(2, 3\).*they must be \(outputs, 4\)"
    ):
        Layers(weights, [np.zeros(4), np.zeros(2)], ["tanh", "identity"])
    with pytest.raises(PolicyError, match="activation 'wave', must be one of identity, tanh, relu"):
        Layers(weights[:1], [np.zeros(4)], ["wave"])


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({}, "cannot read .*policy.json: No such file"),
        ({"policy.json": "{"}, "is not valid JSON"),
        ({"policy.json": "[]"}, "must hold a JSON object"),
        ({"policy.json": json.dumps({"environment": DESCRIPTION})}, "has no 'network'"),
        ({"policy.json": json.dumps({"environment": [], "network": {}})}, "has no 'environment'"),
        ({"policy.json": []}, "has no 'network'"),
        ({"policy.json": {"kind": "layers", "file": "gone.npz"}}, "gone.npz is missing"),
        ({"policy.json": {"kind": "oracle", "file": "policy.json"}}, "kind 'oracle'; the kinds are layers"),
        ({"policy.json": {"kind": "layers", "file": "policy.json"}}, "holds no layers"),
    ],
)
def test_a_folder_without_a_policy_is_refused(files: dict[str, Any], message: str, tmp_path: Path) -> None:
    for name, content in files.items():
        policy = {"environment": DESCRIPTION, "network": content}
        (tmp_path / name).write_text(content if isinstance(content, str) else json.dumps(policy))
    with pytest.raises(PolicyError, match=message):
        Policy(tmp_path)


LAYERS = {"kind": "layers", "file": "network.npz", "activations": ["identity"], "head": "scores"}


def submission(folder: Path, arrays: dict[str, Any] | None = None, **changes: Any) -> Path:
    """Write a policy of one layer, which chooses by nine scores."""
    np.savez(folder / "network.npz", **arrays or {"weight_0": np.ones((9, 7)), "bias_0": np.ones(9)})
    network = {**LAYERS, **changes.pop("network", {})}
    policy = {"environment": DESCRIPTION, "network": network, **changes}
    (folder / "policy.json").write_text(json.dumps(policy))
    return folder


def test_a_policy_chooses_at_random_unless_its_file_says_otherwise(tmp_path: Path) -> None:
    assert Policy(submission(tmp_path)).chooser.outputs == 9
    assert Policy(submission(tmp_path, choose="deterministic")).chooser.outputs == 9


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"choose": "wisely"}, "choose is 'wisely', must be sampled or deterministic"),
        ({"choose": None}, "choose is None, must be"),
        ({"network": {"activations": None}}, "activations is None, must be a list of names"),
        ({"network": {"activations": [["tanh"]]}}, "must be a list of names"),
        ({"network": {"deviations": ["wide"]}}, "deviations is .*, must be a list of numbers"),
        ({"arrays": {"weight_0": np.array([["a"]]), "bias_0": np.ones(1)}}, "holds <U1, must hold numbers"),
    ],
)
def test_a_wrong_value_in_a_policy_is_named(changes: dict[str, Any], message: str, tmp_path: Path) -> None:
    with pytest.raises(PolicyError, match=message):
        Policy(submission(tmp_path, **changes))


def test_a_file_without_layers_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "network.npz"
    number = {"weight_0": np.float32(1.0), "bias_0": np.ones(1, np.float32)}
    for write, message in (
        (lambda file: None, "No data left in file"),
        (lambda file: np.save(file, np.ones(3)), "'numpy.ndarray' object"),
        (lambda file: np.savez(file, **number), "a weight is a single number"),
    ):
        with path.open("wb") as file:
            write(file)
        with pytest.raises(PolicyError, match=rf"npz holds no layers: {message}.*; its arrays must be"):
            read_layers(path)


def test_a_file_that_is_no_onnx_network_is_refused(tmp_path: Path) -> None:
    pytest.importorskip("onnxruntime")
    (tmp_path / "network.onnx").write_bytes(b"no network")
    with pytest.raises(PolicyError, match="ONNX Runtime cannot load"):
        OnnxNetwork(tmp_path / "network.onnx")

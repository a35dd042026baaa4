"""The trainers of ``docs/training.md`` take the environments as they are: its programs train, in small."""

import copy
import json
import math
import re
import runpy
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

from wildscav_engine.envs import SingleEnv, parallel_env
from wildscav_engine.specs.map_spec import MapConfig, MapSpec

# The trainers warn of much, most of all of one another.
pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]

TEXT = (Path(__file__).parents[2] / "docs" / "training.md").read_text("utf-8")
EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"
BLOCKS = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
NAVIGATION = "wildscav_engine.envs:WildScav/Navigation-v1"
TINY = MapSpec(config=MapConfig(size=40, relief=0, water=0, houses=0, vegetation=0), seed=1)
SHORT = {"map": TINY, "time_limit": 4.0}
MODES = ("box", "baseline", "multidiscrete")
# The programs train on real maps for an hour; here it is some hundred steps on a lawn.
IN_SMALL = {
    '"level": "easy"': '"map": TINY, "time_limit": 2.0',
    'save("seeing")': "get_parameters()",
    "range(5)": "range(2)",
    "20_000": "256",
    'level="easy"': "map=TINY, time_limit=2.0",
    "1_000_000": "512",
    "n_steps=256": "n_steps=32",
    "=4800": "=256",
    "=600": "=256",
    "=400": "=64",
    '"time_limit": 30.0': '"time_limit": 2.0',
    '"width": 64': '"width": 40',
    "=2048": "=256",
    "=512": "=64",
    "range(250)": "range(2)",
    'save("navigation")': "get_parameters()",
}


def test_each_replacement_makes_some_program_smaller() -> None:
    names = ("pictures_ppo", "rllib_ppo", "rllib_team", "torchrl_ppo")
    codes = [BLOCKS[0], *((EXAMPLES / f"{name}.py").read_text("utf-8") for name in names)]
    assert [long for long in IN_SMALL if not any(long in code for code in codes)] == []


@pytest.fixture(autouse=True)
def one_thread() -> None:
    """Let small networks not fight for cores."""
    torch = pytest.importorskip("torch")
    torch.set_num_threads(1)


def program(name: str) -> tuple[str, str]:
    """Return an example, or the code of the page, in small: up to the line that trains, and the rest."""
    code = BLOCKS[0] if name == "page" else (EXAMPLES / f"{name}.py").read_text("utf-8")
    for long, short in IN_SMALL.items():
        code = code.replace(long, short)
    training = re.search(r"^(for |model\.learn)", code, re.MULTILINE)
    assert training is not None
    return code[: training.start()], code[training.start() :]


def run(code: str, names: dict[str, Any]) -> dict[str, Any]:
    exec(compile(code, "docs/training.md", "exec"), names)  # noqa: S102
    return names


def changed(before: dict[str, Any], after: dict[str, Any]) -> bool:
    """Say whether learning moved weights, all of which are numbers still."""
    assert before.keys() == after.keys()
    assert all(np.isfinite(np.asarray(value)).all() for value in after.values())
    return any(not np.array_equal(before[name], after[name]) for name in before)


def weights_of(module: Any) -> dict[str, Any]:
    return {name: value.detach().cpu().numpy().copy() for name, value in module.state_dict().items()}


def test_what_the_page_says_of_going_on_are_options() -> None:
    lines = re.findall(r"`((?:rewards|start_range|opponents|split)=[^`]+)`", TEXT)
    assert len(lines) == 4
    for line in lines:
        SingleEnv("battle" if line.startswith("opponents") else "navigation", **eval(f"dict({line})"))  # noqa: S307


@pytest.mark.parametrize("name", ["page", "pictures_ppo"])
def test_stable_baselines_trains_as_the_page_says(name: str) -> None:
    pytest.importorskip("stable_baselines3")
    start, train = program(name)
    names = run(start, {"TINY": TINY})
    model = names["model"]
    before = weights_of(model.policy)
    run(train, names)
    assert model.num_timesteps >= 512
    assert changed(before, weights_of(model.policy))
    assert math.isfinite(model.logger.name_to_value["train/loss"])
    assert model.ep_info_buffer  # episodes ended, and the monitor saw it


@pytest.mark.parametrize(("mode", "flat"), [("box", False), ("baseline", True), ("multidiscrete", False)])
def test_the_checker_of_stable_baselines_finds_nothing(mode: str, flat: bool) -> None:
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    checker.check_env(SingleEnv("navigation", action_mode=mode, flat=flat, **SHORT))


def test_the_vector_of_stable_baselines_is_the_single_environments_row_by_row() -> None:
    pytest.importorskip("stable_baselines3")
    from wildscav_engine.envs import StableVector

    options: dict[str, Any] = {"action_mode": "box", "flat": True, "map": TINY, "time_limit": 1.0}
    vector = StableVector("navigation", 2, **options)
    vector.seed(5)
    singles = [SingleEnv("navigation", **options) for _ in range(2)]
    wanted = np.stack([env.reset(seed=5 + row)[0] for row, env in enumerate(singles)])
    np.testing.assert_array_equal(vector.reset(), wanted)
    generator = np.random.default_rng(0)
    for step in range(1, 26):
        actions = generator.uniform(-1, 1, (2, *vector.action_space.shape)).astype(np.float32)
        observations, rewards, done, infos = vector.step(actions)
        for row, env in enumerate(singles):
            last, reward, terminated, truncated, told = env.step(actions[row])
            assert (rewards[row], done[row]) == (np.float32(reward), terminated or truncated)
            for name in ("events", "reward_terms", "metrics"):
                assert list(infos[row][name].values()) == pytest.approx(told[name].tolist()), name
            assert list(infos[row]["metrics"]) == list(vector.vector.arena.metrics)
            if terminated or truncated:
                np.testing.assert_array_equal(infos[row]["terminal_observation"], last)
                assert infos[row]["TimeLimit.truncated"] == (truncated and not terminated)
                last, _ = env.reset()
            np.testing.assert_array_equal(observations[row], last)
        assert done.all() == (step % 10 == 0)  # ten steps are the second that a match takes


def test_the_monitor_of_stable_baselines_keeps_metrics_and_passes_options_on() -> None:
    pytest.importorskip("stable_baselines3")
    from stable_baselines3.common.vec_env import VecMonitor

    from wildscav_engine.envs import StableVector

    options: dict[str, Any] = {"action_mode": "box", "map": TINY, "time_limit": 0.4, "sensors": {}}
    vector = StableVector("navigation", 2, **options)
    envs = VecMonitor(vector, info_keywords=("metrics", "reward_terms"))
    envs.seed(1)
    envs.reset()
    envs.set_options({"start_range": 2.0})
    for _ in range(4):
        observations, _, done, infos = envs.step(np.zeros((2, 5), np.float32))
    assert done.all()
    assert (observations["target"][:, 7] < 8.0).all()  # of the next episode, approximately in the range
    for info in infos:
        assert info["episode"]["metrics"].keys() == set(vector.vector.arena.metrics)
        assert info["episode"]["reward_terms"].keys() == {"target_reached"}
    for wrong, message in (
        ([{"time_limit": 0.2}, {"start_range": -3.0}], "^start_range: Input should be greater"),
        ([{"time_limit": 0.2}, {"map": 10**7}], "^map: id is 10000000"),
        ([{"time_limit": 0.2}], "^1 sets of options are given for 2 environments$"),
    ):
        with pytest.raises(ValueError, match=message):
            envs.set_options(wrong)
    envs.set_options([None, {"time_limit": 0.2}])
    envs.reset()
    assert [envs.step(np.zeros((2, 5), np.float32))[2].tolist() for _ in range(2)][-1] == [False, True]


def test_the_curriculum_of_the_page_begins_with_its_first_stage() -> None:
    (code,) = [text for text in BLOCKS if "AdaptiveOptions" in text]
    levels = ', {"level": "normal"}, {"level": "hard"}'  # a map has no levels
    names = run(code.replace('level="easy"', "map=TINY").replace(levels, ""), {"TINY": TINY})
    assert names["infos"]["stage"].tolist() == [0] * 16


def test_the_example_of_level_replay_plays_the_levels_from_which_there_is_most_to_learn(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("stable_baselines3")
    example = EXAMPLES / "level_replay.py"
    names = runpy.run_path(str(example))
    levels = names["Levels"](4)
    assert levels.draw() in range(4)
    levels.update(np.array([[0, 2], [0, 2]]), np.array([[0.1, -2.0], [-0.1, 1.0]], np.float32))
    assert levels.scores[[0, 2]].tolist() == pytest.approx([0.1, 1.5])
    chances = levels.chances()  # 0.9 by rank, of which the second gets (1 / 2) ** 10; 0.1 by age
    assert chances.tolist() == pytest.approx([0.9 / 1025 + 0.05, 0.9 * 1024 / 1025 + 0.05])
    monkeypatch.setattr(sys, "argv", [str(example), "--steps", "8192", "--levels", "8"])
    runpy.run_path(str(example), run_name="__main__")
    said = capsys.readouterr().out
    assert re.match(r"[4-8] levels played; \d+% of the last episodes succeeded\nlevel ", said)


def test_the_notebook_runs_as_it_stands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("stable_baselines3")
    notebook = json.loads((EXAMPLES / "first_experiment.ipynb").read_text("utf-8"))
    cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    monkeypatch.chdir(tmp_path)
    small = {"100_000": "5_000", '"time_limit": 30.0': '"map": TINY, "time_limit": 2.0', ', split="test"': ""}
    names: dict[str, Any] = {"TINY": TINY}
    for code in cells:
        for long, short in small.items():
            code = code.replace(long, short)  # noqa: PLW2901
        run(code, names)
    assert names["observation"].shape == names["env"].observation_space.shape
    assert (tmp_path / "match.webp").stat().st_size > 0


@pytest.fixture
def ray() -> Iterator[Any]:
    ray = pytest.importorskip("ray")
    pytest.importorskip("ray.rllib")
    ray.init("local", num_cpus=1, include_dashboard=False, log_to_driver=False)
    yield ray
    ray.shutdown()


def test_rllib_trains_as_the_page_says(ray: Any) -> None:
    for name, policy in (("rllib_ppo", "default_policy"), ("rllib_team", "everybody")):
        start, train = program(name)
        names = run(start, {"TINY": TINY})
        algorithm = names["algorithm"]
        before = copy.deepcopy(algorithm.get_weights()[policy])
        run(train, names)
        assert changed(before, algorithm.get_weights()[policy])
        result = algorithm.train()
        assert math.isfinite(result["learners"][policy]["total_loss"])
        assert result["env_runners"]["num_env_steps_sampled_lifetime"] >= 512
        assert result["env_runners"]["num_episodes_lifetime"] > 0
        algorithm.stop()


def test_torchrl_trains_as_the_page_says() -> None:
    torch = pytest.importorskip("torch")
    pytest.importorskip("torchrl")
    torch.manual_seed(0)
    start, train = program("torchrl_ppo")
    names = run(start, {"TINY": TINY})
    before = {part: weights_of(names[part]) for part in ("actor", "critic")}
    run(train, names)
    for part, weights in before.items():
        assert changed(weights, weights_of(names[part])), part
    losses = names["loss"](names["batch"])
    assert all(torch.isfinite(losses[name]).all() for name in ("loss_objective", "loss_critic"))


@pytest.mark.parametrize(("mode", "flat"), [("box", True), ("baseline", False), ("dict", False)])
def test_the_checker_of_torchrl_finds_nothing(mode: str, flat: bool) -> None:
    envs = pytest.importorskip("torchrl.envs")
    envs.check_env_specs(envs.GymEnv(NAVIGATION, action_mode=mode, flat=flat, **SHORT))


@pytest.mark.parametrize("autoreset", ["Disabled", "SameStep"])
def test_torchrl_plays_a_vector_past_the_end_of_matches(autoreset: str) -> None:
    envs = pytest.importorskip("torchrl.envs")
    vector = gymnasium.make_vec(
        NAVIGATION,
        num_envs=3,
        vectorization_mode="vector_entry_point",
        autoreset_mode=autoreset,
        action_mode="box",
        flat=True,
        **SHORT,
    )
    played = envs.GymWrapper(vector).rollout(90, break_when_any_done=False)
    assert played.batch_size == (3, 90)
    assert played["next", "truncated"].sum() == 6  # 40 steps are the 4 s that a match takes


@pytest.mark.parametrize("mode", MODES)
def test_torchrl_plays_with_several_learners(mode: str) -> None:
    envs = pytest.importorskip("torchrl.envs")
    zoo = parallel_env("battle", agents=3, action_mode=mode, flat=True, **SHORT)
    env = envs.PettingZooWrapper(zoo, return_state=True)
    envs.check_env_specs(env)
    played = env.rollout(5)
    assert played["agent", "observation"].shape[:2] == (5, 3)
    assert ("agent", "action_mask") in played.keys(include_nested=True) or mode == "box"

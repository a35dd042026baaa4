"""Data sets on disk: Minari reads back what was played, and its environment starts where an episode did."""

import json
import runpy
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from tests.end_to_end.pages import json_documents, names
from tests.engine.envs.common import OPEN, digest, many_options
from tests.platform.training.datasets.common import at, write_match
from typer.testing import CliRunner

from wildscav.cli.main import app
from wildscav_engine.envs.batched import multi_agent_config
from wildscav_engine.envs.registry import env_id
from wildscav_training.cli.from_policy import policy_files
from wildscav_training.datasets.from_agent import PlayedEpisodes

minari = pytest.importorskip("minari")
pytestmark = pytest.mark.slow  # Minari is installed for the slow tests alone

HERE = ("--option", f"map={json.dumps(OPEN.model_dump(mode='json'))}", "--option", "time_limit=4")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path / "sets"))
    return tmp_path / "sets"


def dataset(*arguments: object) -> Any:
    return CliRunner().invoke(app, ["dataset", *map(str, arguments)])


def test_minari_reads_the_episodes_of_an_agent() -> None:
    done = dataset("--agent", "homing", "--matches", 3, "--id", "navigation/homing-v0", "--json", *HERE)
    assert done.exit_code == 0, (done.output, done.exception)
    assert names(json.loads(done.stdout)) == json_documents()["dataset"]
    data = minari.load_dataset("navigation/homing-v0")
    given = {"map": OPEN, "time_limit": 4.0}
    played = [episode for (episode,) in PlayedEpisodes("homing", "navigation", given, matches=3)]
    assert data.total_episodes == 3
    assert data.total_steps == json.loads(done.stdout)["steps"] == sum(len(one.rewards) for one in played)
    for stored, episode in zip(data.iterate_episodes(), played, strict=True):
        assert digest(stored.observations) == digest(episode.observations)
        assert digest(stored.actions) == digest(episode.actions)
        assert stored.rewards.tolist() == episode.rewards.tolist()
        assert stored.terminations.tolist() == episode.terminations.tolist()
    assert data.storage.metadata["algorithm_name"] == "homing"
    metadata = list(data.storage.get_episode_metadata(range(3)))
    assert [one["metrics"]["success"] for one in metadata] == [
        one.about["metrics"]["success"] for one in played
    ]
    env = data.recover_environment()
    for stored, one in zip(data.iterate_episodes(), metadata, strict=True):
        first, _ = env.reset(seed=one["seed"])
        assert digest(dict(first)) == digest(at(stored.observations, 0))
    env.close()


def test_minari_reads_the_teams_of_records(tmp_path: Path) -> None:
    config = multi_agent_config("battle", many_options("battle"))
    paths = [tmp_path / f"{seed}.wsr" for seed in (1, 2)]
    steps = [write_match(path, config, seed).step_number for seed, path in enumerate(paths)]
    flat = ("--option", "flat=true", "--option", "action_mode=multidiscrete")
    assert dataset(*paths, "--id", "pairs-v1", "--seat", 0, "--seat", 2, "--together", *flat).exit_code == 0
    data = minari.load_dataset("pairs-v1")
    assert set(data.observation_space.spaces) == set(data.action_space.spaces) == {"agent_0", "agent_1"}
    for stored, length in zip(data.iterate_episodes(), steps, strict=True):
        assert stored.observations["agent_1"].shape == (length + 1, *data.observation_space["agent_1"].shape)
        assert stored.actions["agent_0"].shape == (length, *data.action_space["agent_0"].shape)
        by_agent = stored.infos["rewards"]
        assert np.allclose(by_agent["agent_0"][1:] + by_agent["agent_1"][1:], stored.rewards)
        assert stored.truncations.tolist() == [False] * (length - 1) + [True]


def test_a_data_set_leaves_the_registered_environments_as_they_are() -> None:
    before = dict(gymnasium.spec(env_id("navigation", 1)).kwargs)
    assert dataset("--agent", "homing", "--matches", 1, "--id", "left-v0", *HERE).exit_code == 0
    assert gymnasium.spec(env_id("navigation", 1)).kwargs == before


def test_pixels_are_stored_as_they_are() -> None:
    camera = ("--option", 'sensors={"camera": {"width": 40, "height": 40}}')
    assert dataset("--agent", "homing", "--matches", 1, "--id", "seen-v0", *camera, *HERE).exit_code == 0
    given = {"map": OPEN, "time_limit": 4.0, "sensors": {"camera": {"width": 40, "height": 40}}}
    ((episode,),) = PlayedEpisodes("homing", "navigation", given, matches=1)
    stored = minari.load_dataset("seen-v0")[0]
    assert stored.observations["camera"].dtype == np.uint8
    assert digest(stored.observations["camera"]) == digest(episode.observations["camera"])


@pytest.mark.parametrize("name", ["no version", "homing", "a/b", "../x-v0"])
def test_an_id_of_another_form_is_said(name: str) -> None:
    done = dataset("--agent", "homing", "--id", name)
    assert done.exception.exit_code == 2
    assert "must be a name and a version, such as" in str(done.exception)


def test_a_data_set_is_never_overwritten_and_nothing_half_is_left(tmp_path: Path, folder: Path) -> None:
    arguments = ("--agent", "homing", "--matches", 1, "--id", "mine-v0", *HERE)
    assert dataset(*arguments).exit_code == 0
    assert "there is a data set mine-v0 already" in str(dataset(*arguments).exception)
    write_match(tmp_path / "a.wsr", multi_agent_config("battle", many_options("battle")), seed=1)
    (tmp_path / "b.wsr").write_bytes(b"nothing of the kind")
    done = dataset(tmp_path / "a.wsr", tmp_path / "b.wsr", "--id", "other-v0")
    assert "b.wsr" in str(done.exception)
    assert not (folder / "other-v0").exists()


def test_the_example_of_the_page_learns_what_the_agent_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("torch")
    form = ("--option", "flat=true", "--option", "action_mode=multidiscrete")
    played = dataset("--agent", "homing", "--matches", 8, "--id", "navigation/mapper-v0", *form, *HERE)
    assert played.exit_code == 0
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(Path(__file__).parents[4] / "docs" / "examples" / "clone.py"))
    losses = [float(line.split()[2]) for line in capsys.readouterr().out.splitlines()]
    assert losses[-1] < 0.5 * losses[0]
    files = policy_files(tmp_path / "clone.npz", "clone", "navigation", form[1::2], "sampled", "tanh")
    assert "network.npz" in files

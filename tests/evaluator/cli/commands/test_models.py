"""`wildscav evaluate --model` as an organizer runs it: what is written down of it, and what is not."""

import gzip
import json
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import ASKER, Command, Submit
from tests.evaluator.small_matches import tiny_suite
from tests.scripted_model import ScriptedModel, in_turn, said

from wildscav_engine.record import read_record
from wildscav_evaluator.check.trials import Trial
from wildscav_evaluator.model_gateway.settings import read_model
from wildscav_evaluator.output.results import read_results
from wildscav_evaluator.sandbox import DEFAULT_LIMITS
from wildscav_evaluator.suites.suite import SUITES

pytestmark = pytest.mark.usefixtures("compiled")
KEY = "sk-the-organizers-own"


def test_an_evaluation_names_its_model_and_its_ledger_what_was_asked(
    submit: Submit, tmp_path: Path, wildscav: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MODEL_KEY", KEY)
    suite, file, out = tiny_suite(tmp_path, maps=1, seconds=1), tmp_path / "model.toml", tmp_path / "out"

    options = ("--suite", suite, "--sandbox=process", "--replays=none", "--out", out, "--model", file)
    with ScriptedModel(in_turn(said("go on")), key=KEY) as model:
        file.write_text(f'url = "{model.url}"\nname = "tiny"\nkey_env = "MODEL_KEY"\n')
        folder = submit("asker", ASKER).folder
        done = wildscav("evaluate", folder, *options)
        file.write_text(file.read_text() + "requests = 3\n")
        other = wildscav("evaluate", folder, *options)

    assert done.returncode == 0, done.stderr
    assert "model     tiny (" in done.stdout
    assert other.returncode == 2
    assert "its model's requests is 2000, not 3" in " ".join(other.stderr.split())
    terms = read_results(out / "results.json").model
    assert terms is not None
    assert (terms.name, terms.requests) == ("tiny", 2000)
    (asked,) = (out / "exchanges").iterdir()
    assert b"go on" in gzip.decompress(asked.read_bytes())
    assert not [path for path in out.rglob("*.json*") if KEY in path.read_bytes().decode("latin-1")]
    assert wildscav("verify", out).returncode == 0
    entries = [json.loads(line)["fact"] for line in (out / "ledger.jsonl").read_text().splitlines()]
    assert [len(one["exchanges"]) for one in entries if one["kind"] == "ended"] == [64]

    asked.write_bytes(gzip.compress(b"{}\n"))
    told = wildscav("verify", out)
    assert told.returncode == 1
    assert "what its agents asked a model is not what" in " ".join((told.stdout + told.stderr).split())


def test_a_match_with_a_model_is_paused_while_agents_think(
    submit: Submit, tmp_path: Path, wildscav: Command
) -> None:
    file, record = tmp_path / "model.toml", tmp_path / "match.wsr"
    with ScriptedModel(in_turn(said("go on"))) as model:
        file.write_text(f'url = "{model.url}"\nname = "tiny"\n')
        options = ("--model", file, "--record", record, "--sandbox=process", "--time-limit=0.5", "--size=40")
        done = wildscav("play", submit("asker", ASKER).folder, *options)

    assert done.returncode == 0, done.stderr
    assert read_record(record).spec.clock == "paused"
    asked = Trial.of(SUITES["quick"], "navigation", DEFAULT_LIMITS).asking(read_model(file), paused=True)
    assert asked.spec.clock == "paused"


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ("url = ", "are not TOML"),
        ('url = "http://host/v1"', "name: field required"),
        ('url = "http://host/v1"\nname = "tiny"\nkey_env = "NOT_SET"', "the variable NOT_SET, which"),
        ('url = "http://host/v1"\nname = "tiny"\nkey_file = "none"', "cannot be read from"),
    ],
)
def test_wrong_settings_are_one_line(
    submit: Submit, tmp_path: Path, wildscav: Command, settings: str, said: str
) -> None:
    (tmp_path / "model.toml").write_text(settings)

    done = wildscav("play", submit("asker", ASKER).folder, "--model", tmp_path / "model.toml")

    assert done.returncode == 2
    assert said.lower() in " ".join(done.stderr.lower().split())

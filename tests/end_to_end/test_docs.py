"""What the README and the pages say is true: their code runs, and the files they name are there."""

import json
import re
import shlex
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest
import typer
from tests.commands import run_command
from tests.end_to_end.pages import blocks, run_code

from wildscav.cli import main
from wildscav.cli.old_names import OPTIONS, with_new_names
from wildscav_engine.maps.catalogue import BENCHMARK, SIZES
from wildscav_engine.specs.map_spec import MapConfig

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])
FILES = subprocess.check_output(("git", "ls-files", "-co", "--exclude-standard"), cwd=ROOT, text=True).split()
CODE = "\n".join(
    path.read_text("utf-8") for name in FILES if (path := ROOT / name).suffix == ".py" and path.exists()
)
HOMES = (
    "engine/wildscav_engine",
    "platform",
    "evaluator/wildscav_evaluator",
    "leaderboard/wildscav_leaderboard",
)


@pytest.mark.slow
def test_the_researchers_lines_run_as_they_stand(tmp_path: Path) -> None:
    (code,) = blocks(ROOT / "README.md", "python")
    assert re.search(r"\(10, 10\) -?\d\.\d+\n$", run_code(code, tmp_path))


def test_every_extra_that_the_pages_install_is_one_and_the_readme_says_where_from() -> None:
    extras = set(
        tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
    )
    named = set()
    for page in PAGES:
        for clone, listed in re.findall(
            r"pip install (-e '\.|'wildscav)\[([a-z,]+)\]'", page.read_text("utf-8")
        ):
            named |= set(listed.split(","))
            # It is not in the package index: who has not installed a clone before has nothing to add to.
            assert (
                clone.startswith("-e")
                or page.name == "README.md"
                or "README.md#install" in page.read_text("utf-8")
            )
    assert {"all", "training"} <= named <= extras
    first = next(
        line for text in blocks(ROOT / "README.md", "console") for line in text.splitlines() if "pip" in line
    )
    assert first.startswith("pip install -e '.[all]'")


def test_every_make_command_of_the_pages_is_a_target() -> None:
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text("utf-8"), re.MULTILINE))
    for page in PAGES:
        named = set(re.findall(r"(?:^|`)make ([a-z-]+)", page.read_text("utf-8"), re.MULTILINE))
        assert named <= targets, page.name


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_within_the_project_lead_somewhere(page: Path) -> None:
    for link in re.findall(r"\]\(([^)#]+)\)", page.read_text("utf-8")):
        if not link.startswith(("http:", "https:")):
            assert (page.parent / link).exists(), link


def test_the_files_that_the_architecture_names_exist() -> None:
    """Each lies in one of the packages, or is named from the top folder."""
    text = (ROOT / "docs" / "architecture.md").read_text("utf-8")
    named = set(re.findall(r"`([a-z0-9_/]+(?:\.py|\.proto|/))`", text))
    assert len(named) > 80
    homes = [ROOT, *(ROOT / home for home in HOMES)]
    for name in named - {f"{home}/" for home in HOMES}:
        assert any((home / name).exists() for home in homes), name


# Files that pages let readers make.
TO_WRITE = {"hills", "orbit", "fort.toml", "spring", "altimeter.py", "eval.py", "model.toml", "my-agent"}


@pytest.mark.parametrize(
    "page", [page for page in PAGES if page.name != "CHANGELOG.md"], ids=lambda page: page.name
)
def test_files_functions_and_tests_that_pages_name_exist(page: Path) -> None:
    text = re.sub(r"^```.*?^```", "", page.read_text("utf-8"), flags=re.MULTILINE | re.DOTALL)
    named = re.findall(r"`([^`\s]+)`", text)
    for name in (one for one in named if re.fullmatch(r"[a-z][\w/.-]+\.(py|js|proto|toml)", one)):
        assert any(f"/{file}".endswith(f"/{name}") for file in FILES) or TO_WRITE & set(name.split("/")), name
    for name in (one for one in named if re.fullmatch(r"_[a-z]\w+|test_\w+", one)):
        assert re.search(rf"(def|class) {name}\b", CODE), name


def test_every_message_of_the_page_of_troubles_is_one() -> None:
    page = (ROOT / "docs" / "troubleshooting.md").read_text("utf-8")
    for message in re.findall(r"^\| (?:outcome )?`([^`]+)`", page, re.MULTILINE):
        assert message in CODE, message


INVERTED = re.compile(
    r"(?:^|[.;:] )(?:Who|Whoever|Whom|Whose|What) (?!.*\?)\w+ \w+|\bwhoever\b", re.MULTILINE
)


@pytest.mark.parametrize(
    "page",
    [page for page in PAGES if page.name not in ("CHANGELOG.md", "CONTRIBUTING.md")],
    ids=lambda page: page.name,
)
def test_no_sentence_of_a_page_begins_with_its_object(page: Path) -> None:
    text = re.sub(r"^(```.*?^```|#.*?$)", "", page.read_text("utf-8"), flags=re.MULTILINE | re.DOTALL)
    assert INVERTED.findall(text) == [], "CONTRIBUTING.md has the rules of English"


def test_the_notebook_that_plots_a_match_runs_as_it_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    notebook = json.loads((ROOT / "docs" / "examples" / "plot_a_match.ipynb").read_text("utf-8"))
    code = "".join(
        "".join(cell["source"]) + "\n" for cell in notebook["cells"] if cell["cell_type"] == "code"
    )
    monkeypatch.setenv("MPLBACKEND", "Agg")
    small = code.replace("size=120", "size=60").replace("time_limit=60", "time_limit=4")
    assert run_code(small, tmp_path) == "5 agents, 41 moments, 4 s\n"
    assert (tmp_path / "match.png").stat().st_size > 0


def test_the_code_and_the_config_of_the_page_of_maps_work(tmp_path: Path) -> None:
    page = ROOT / "docs" / "maps.md"
    code = "\n".join(blocks(page, "python"))
    assert run_code(code, tmp_path) == "True True\n"
    (text,) = blocks(page, "toml")
    (tmp_path / "fort.toml").write_text(text, "utf-8")
    config = MapConfig.model_validate(tomllib.loads(text))
    assert [one.kind for one in config.placements] == ["house", "tree"]
    strewn = config.supplies
    assert strewn is not None
    assert [wave.time for wave in strewn.waves] == [0.0, 60.0]
    show = ("map", "show", "--config", "fort.toml", "--seed", "1", "--width", "300")
    assert run_command(*show, cwd=tmp_path).returncode == 0


def test_the_page_of_maps_tells_the_benchmark_and_the_sizes_of_the_hundreds() -> None:
    text = (ROOT / "docs" / "maps.md").read_text("utf-8")
    rows = re.findall(r"^\| (\d{3}) \| (\d+) m \| (\d+) \| (\w+) \| (\d)(?:–(\d))? \|$", text, re.MULTILINE)
    told = {
        int(number): (int(size), int(houses), density, (int(low), int(high or low)))
        for number, size, houses, density, low, high in rows
    }
    assert told == {
        number: (config.size, config.houses, config.density, config.storeys)
        for number, config in BENCHMARK.items()
    }
    assert ", ".join(str(size) for size in SIZES) + " m for 0 to 9" in text


def commands_of(page: Path) -> list[list[str]]:
    """The words of every command of a page but those within others, without where its output goes."""
    text = "\n".join(blocks(page, "console")).replace("\\\n", " ")
    lines = re.findall(r"^wildscav .*", re.sub(r"\$\(.*?\)", "said", text), re.MULTILINE)
    found = [shlex.split(line, comments=True)[1:] for line in lines]
    return [words[: words.index(">")] if ">" in words else words for words in found]


COMMANDS = {" ".join(words): words for page in PAGES for words in commands_of(page)}
OF_THE_SHELL = ("--install-completion", "--show-completion")  # which act when they are read


@pytest.mark.parametrize(
    "words", [words for words in COMMANDS.values() if words[0] not in OF_THE_SHELL], ids=" ".join
)
def test_every_command_of_the_pages_takes_what_it_is_given(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    command: Any = typer.main.get_command(main.app)
    with_new_names(words, command, None)
    assert capsys.readouterr().err == "", "an old name"
    while hasattr(command, "get_command"):
        name, *words = words
        command = command.get_command(None, name)
    with command.make_context(name, words) as context:
        assert not context.args


@pytest.mark.parametrize(
    "page", [page for page in PAGES if page.name != "CHANGELOG.md"], ids=lambda page: page.name
)
def test_no_page_names_an_option_by_its_old_name(page: Path) -> None:
    assert not OPTIONS[""].keys() & set(re.findall(r"`(--[a-z-]+)", page.read_text("utf-8")))

"""Files that hosts of repositories and tools read: each is valid and names what there is."""

import re
import shlex
import shutil
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]


def read(name: str) -> Any:
    return yaml.safe_load((ROOT / name).read_text("utf-8"))


def test_the_hosted_checks_run_each_part_of_the_checks_once() -> None:
    (job,) = read(".github/workflows/ci.yml")["jobs"].values()
    command = next(step["run"] for step in job["steps"] if ".ci/run" in step.get("run", ""))
    assert command == "bash .ci/run ${{ matrix.part }}"
    known = re.search(r"in all \| ([\w |]+)\)", (ROOT / ".ci" / "run").read_text("utf-8"))
    shares: dict[str, list[str]] = {}
    for entry in job["strategy"]["matrix"]["include"]:
        shares.setdefault(entry["part"], []).append(entry.get("share", "1/1"))
    assert known
    assert list(shares) == known[1].split(" | ")
    for part in shares.values():
        assert part == [f"{number + 1}/{len(part)}" for number in range(len(part))]


def test_the_citation_is_of_the_project_and_names_the_paper() -> None:
    citation = read("CITATION.cff")
    assert citation["cff-version"] == "1.2.0"
    assert {"message", "title", "authors"} <= set(citation), "what the format asks for"
    assert (citation["version"], citation["license"]) == (PROJECT["version"], PROJECT["license"])
    assert citation["abstract"] == PROJECT["description"]
    assert re.fullmatch(r"\d{4}-\d\d-\d\d", citation["date-released"])
    (paper,) = citation["references"]
    assert all({"family-names", "given-names"} == set(author) for author in paper["authors"])
    assert paper["title"] in (ROOT / "README.md").read_text("utf-8")


def test_the_manifest_for_openenv_has_the_projects_version() -> None:
    assert read("platform/wildscav_language/openenv/openenv.yaml")["version"] == PROJECT["version"]


def test_hooks_before_commits_run_the_programs_of_make_check() -> None:
    makefile = (ROOT / "Makefile").read_text("utf-8")
    (local,) = read(".pre-commit-config.yaml")["repos"]
    for hook in local["hooks"]:
        program, *words = shlex.split(hook["entry"])
        command = " ".join([program.replace(".venv/bin", "$(BIN)"), *words[:1]])
        assert command in makefile, hook["id"]
    if shutil.which("pre-commit"):
        subprocess.run(["pre-commit", "validate-config"], cwd=ROOT, check=True)


@pytest.mark.parametrize("name", ["SECURITY.md", "CODE_OF_CONDUCT.md", ".github/pull_request_template.md"])
def test_links_of_a_page_for_hosts_lead_to_files(name: str) -> None:
    page = ROOT / name
    text = page.read_text("utf-8")
    for target in re.findall(r"\]\(([^)#]+)", text):
        assert (page.parent / target).is_file(), target
    assert "@" not in text, "nobody's address"

"""Submissions as images, by each container engine; nothing is fetched."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests.evaluator.sandbox.conftest import engine_named, missing

from wildscav_evaluator.cli.selection import load_submissions
from wildscav_evaluator.sandbox import SandboxError
from wildscav_evaluator.sandbox.engine import ENGINES, bare_image, call, find_engine
from wildscav_evaluator.submissions.images import (
    IMAGE,
    build_image,
    built_name,
    load_image,
    with_images,
)
from wildscav_evaluator.submissions.submission import Submission, SubmissionError, load_submission

pytestmark = pytest.mark.slow
Submit = Callable[..., Submission]
CODE_ALONE = "ARG BASE\nFROM ${BASE}\nCOPY . /submission\n"


@pytest.fixture(autouse=True, params=ENGINES)
def _engine(request: pytest.FixtureRequest) -> Iterator[None]:
    with engine_named(request.param, request):
        if missing("oci"):
            pytest.skip(missing("oci"))
        before = images()
        yield
        for image in images() - before:
            call(find_engine(), "rmi", "-f", image)


def images() -> set[str]:
    listed = call(find_engine(), "images", "-q", "--filter", "reference=localhost/wildscav/*")
    return set(listed.stdout.decode().split())


def build(submission: Submission, folder: Path) -> str:
    """Build an image with the code alone, on an empty one."""
    dockerfile = folder / "own.Dockerfile"
    dockerfile.write_text(CODE_ALONE)
    base = bare_image(find_engine(), ("/tmp",), ())  # noqa: S108
    return build_image(submission, base=base, dockerfile=dockerfile)


def test_a_built_submission_runs_as_its_image_in_containers_alone(submit: Submit, tmp_path: Path) -> None:
    submission = submit("built")

    name = build(submission, tmp_path)

    assert name == built_name(submission)
    assert with_images([submission], "oci")[0].image == name
    assert with_images([submission], "bubblewrap")[0].image is None


def test_what_needs_packages_is_built_first_and_again_when_it_changes(submit: Submit, tmp_path: Path) -> None:
    folder = submit("needy").folder
    (folder / "requirements.txt").write_text("numpy\n")
    with pytest.raises(SubmissionError, match=r"has a requirements\.txt and was not built as it is now"):
        with_images([load_submission(folder)], "oci")

    build(load_submission(folder), tmp_path)
    assert with_images([load_submission(folder)], "oci")[0].image is not None

    (folder / "agent.py").write_text("print('changed')")
    with pytest.raises(SubmissionError, match=f"wildscav build {folder}"):
        with_images([load_submission(folder)], "oci")


def test_a_prebuilt_image_tells_its_own_manifest(submit: Submit, tmp_path: Path) -> None:
    name = build(submit("brought"), tmp_path)

    (loaded,) = load_submissions([Path(IMAGE + name)])

    assert loaded.name == "brought"
    assert loaded.image == name
    assert len(loaded.digest) == 32
    with pytest.raises(SubmissionError, match="which --sandbox bubblewrap does not run"):
        with_images([loaded], "bubblewrap")


def test_an_image_that_is_not_there_or_has_no_manifest_is_refused() -> None:
    with pytest.raises(SubmissionError, match="there is no image localhost/wildscav/nobody on this machine"):
        load_image("localhost/wildscav/nobody")
    with pytest.raises(SubmissionError, match=r"has no /submission/submission\.toml"):
        load_image(bare_image(find_engine(), ("/tmp", "/submission"), ()))  # noqa: S108


def test_a_build_that_fails_is_told(submit: Submit, tmp_path: Path) -> None:
    broken = tmp_path / "broken.Dockerfile"
    broken.write_text("FROM scratch\nCOPY no-such-file /\n")

    with pytest.raises(SandboxError, match="could not be built"):
        build_image(submit("broken"), base="scratch", dockerfile=broken)

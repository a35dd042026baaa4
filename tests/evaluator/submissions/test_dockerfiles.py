"""Our own Dockerfiles, built and run, with the container engine of this machine."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import Submit
from tests.evaluator.small_matches import NAVIGATION, need, play
from tests.evaluator.submissions.python_image import NAME, python_image

from wildscav_evaluator.matches.play import MatchAssignment
from wildscav_evaluator.sandbox.containers.container_engine import ContainerEngine, call, find_engine
from wildscav_evaluator.submissions import images
from wildscav_evaluator.submissions.images import base_name, build_image, with_images
from wildscav_evaluator.submissions.submission import load_submission

pytestmark = [pytest.mark.slow, pytest.mark.long, pytest.mark.usefixtures("python")]
SUBMISSION = "localhost/wildscav/builds-and-walks"
BODY = """
    def act(self, observation):
        import colorama  # which its requirements.txt brought
        return Action(walk_speed=5.0)
"""


@pytest.fixture
def python(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """An image to build on; it and the base go afterwards."""
    need("oci")
    engine = find_engine()
    monkeypatch.setenv(images.PYTHON, python_image(engine))
    yield
    for image in (*built(engine), base_name(NAME), NAME):
        call(engine, "rmi", "-f", image)


def built(engine: ContainerEngine) -> list[str]:
    return call(engine, "images", "-q", SUBMISSION).stdout.decode().split()


def test_a_match_is_played_in_an_image_of_our_own_dockerfiles(submit: Submit, tmp_path: Path) -> None:
    """The base with the SDK, on it the submission with its packages, and a match in it, without a network."""
    folder = submit(SUBMISSION.rpartition("/")[2], BODY).folder
    (folder / "requirements.txt").write_text("colorama\n")
    walker = load_submission(folder)
    build_image(walker, options=["--network=host", "--layers=false"])

    seating = MatchAssignment(NAVIGATION, with_images([walker], "oci"), (tmp_path / "log",))
    played = play(seating, "oci")

    assert played.seats[0].status == "finished"
    assert played.seats[0].steps_played == 20

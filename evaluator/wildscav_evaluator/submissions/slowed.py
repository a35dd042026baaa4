"""A submission that is slowed down on purpose, to measure what its thinking costs."""

import re
import shutil
from pathlib import Path

from wildscav.errors import UserError
from wildscav.sdk.submission_folder import MANIFEST
from wildscav_evaluator.submissions.submission import Submission, load_submission

ENTRY_POINT = re.compile(r"^entry_point\s*=.*$", re.MULTILINE)
CODE = '''"""Waits before every decision of another agent."""

import time

from {module} import {name} as Thinker


class Slowed(Thinker):
    """The agent, which thinks longer."""

    def act(self, observation):
        time.sleep({seconds!r})
        return super().act(observation)
'''


def slowed(submission: Submission, seconds: float, folder: Path) -> Submission:
    """Return a copy, in a new folder, of a submission that waits for some seconds in each decision.

    UserError if it is no folder with an agent in Python, or one that plays by words.
    """
    module, _, name = (submission.manifest.entry_point or "").partition(":")
    if submission.image is not None or not name:
        raise UserError(f"--think slows down agents in Python alone, and {submission.name} is none", 2)
    if submission.manifest.interface == "words":
        raise UserError(
            f"--think slows down each step, and {submission.name} plays many of them by one call", 2
        )
    shutil.copytree(submission.folder, folder)
    (folder / "slowed_down.py").write_text(CODE.format(module=module, name=name, seconds=seconds), "utf-8")
    manifest = folder / MANIFEST
    text = manifest.read_text("utf-8")
    manifest.write_text(ENTRY_POINT.sub('entry_point = "slowed_down:Slowed"', text, count=1), "utf-8")
    return load_submission(folder)

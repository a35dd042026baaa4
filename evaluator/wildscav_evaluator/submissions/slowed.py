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

{method}
'''
# Of agents that act in each step, and of those that play by calls of tools.
ACT = """\
    def act(self, observation):
        time.sleep({seconds!r})
        return super().act(observation)"""
PLAY = """\
    def play(self, seat):
        call = seat.call

        def think_and_call(*arguments, **named):
            time.sleep({seconds!r})
            return call(*arguments, **named)

        seat.call = think_and_call
        return super().play(seat)"""


def slowed(submission: Submission, seconds: float, folder: Path) -> Submission:
    """Return a copy, in a new folder, of a submission that waits for some seconds in each decision.

    UserError if it is no folder with an agent in Python.
    """
    module, _, name = (submission.manifest.entry_point or "").partition(":")
    if submission.image is not None or not name:
        raise UserError(f"--think slows down agents in Python alone, and {submission.name} is none", 2)
    method = (PLAY if submission.manifest.interface == "words" else ACT).format(seconds=seconds)
    code = CODE.format(module=module, name=name, method=method)
    shutil.copytree(submission.folder, folder)
    (folder / "slowed_down.py").write_text(code, "utf-8")
    manifest = folder / MANIFEST
    text = manifest.read_text("utf-8")
    manifest.write_text(ENTRY_POINT.sub('entry_point = "slowed_down:Slowed"', text, count=1), "utf-8")
    return load_submission(folder)

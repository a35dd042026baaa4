"""Submissions for seasons' tests, written into folders."""

from pathlib import Path

from tests.evaluator.sample_agents import CRASHER, WALKER

HEAD = """
import os, time
from wildscav import Action, Agent

class Player(Agent):
"""
MANIFEST = """
name = "{name}"
version = "1.0"
entry_point = "agent:Player"
tracks = {tracks}
"""
BODIES = {"walker": WALKER, "crasher": CRASHER}


def write_agent(folder: Path, name: str, body: str = WALKER, tracks: str = '["navigation"]') -> Path:
    """Write a submission into a new folder, and return it."""
    folder = folder / name
    folder.mkdir(parents=True)
    (folder / "submission.toml").write_text(MANIFEST.format(name=name, tracks=tracks))
    (folder / "agent.py").write_text(f"{HEAD}{body}")
    return folder

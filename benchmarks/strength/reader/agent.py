"""An agent that plays by the texts of a seat of words alone: it reads them, and calls tools."""

import re
from typing import Any

from wildscav import Action, Agent, MatchInfo, Observation
from wildscav_language.player import Player

BOX = re.compile(r"^- box (\d+): .*?([\d.]+) m(?:, ([\d.]+) m (?:higher|lower))?, (\d+) supplies$", re.M)
HEADING = re.compile(r"bearing (\d+)°")
HERE = re.compile(r"^- box (\d+): right here", re.M)
STOREY = 4.0  # m on foot for each metre up or down
START_UP = 3.0  # m, that every box costs besides


class Reader(Agent):
    """Walks to the target, or to the box that is worth most for its way; explores if there is none."""

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""
        self.player = Player(match)
        self.failed: dict[int, int] = {}  # tries of boxes that were not reached
        self.stuck = 0  # times in a row

    def act(self, observation: Observation) -> Action:
        """Play on, and decide whenever a tool has ended."""
        self.player.see(observation)
        while (action := self.player.action()) is None:
            reply = self.player.reply
            name, arguments = self.decide(reply.text or self.player.text(), reply.ended.value)
            self.player.give(name, arguments)
        return action

    def decide(self, text: str, ended: str) -> tuple[str, dict[str, Any]]:
        """Return the next call, from a text and the reason of the last end."""
        self.stuck = self.stuck + 1 if ended == "stuck" else 0
        if self.stuck:
            heading = HEADING.search(text)
            off = (90, -90, 180)[self.stuck % 3] + (int(heading[1]) if heading else 0)
            self.stuck += 1
            return "go", {"bearing": off % 360, "seconds": 2.0, "stop_for": []}
        if "\nTarget: " in text and "not found yet" not in text:
            return "go", {"place": "target", "seconds": 30.0, "stop_for": []}
        box = self.best_box(text)
        if box is not None:
            self.failed[box] = self.failed.get(box, 0) + 1
            return "go", {"box": box, "seconds": 8.0, "stop_for": []}
        return "explore", {"seconds": 5.0, "stop_for": ["box"]}

    def best_box(self, text: str) -> int | None:
        """Return the number of the box with the shortest way for its worth that did not fail twice."""
        found = {int(one[1]): self.effort(one) for one in BOX.finditer(text)}
        found |= {int(one[1]): 0.0 for one in HERE.finditer(text)}
        tried = {box: cost for box, cost in found.items() if self.failed.get(box, 0) < 2}
        return min(tried, key=lambda box: tried[box], default=None)

    @staticmethod
    def effort(line: re.Match[str]) -> float:
        """Return what a box costs for its worth."""
        way = float(line[2]) + STOREY * float(line[3] or 0.0)
        return (way + START_UP) / float(line[4]) ** 0.6

"""An agent that plays by the texts of a seat of words alone: it reads them, and calls tools."""

import re
from typing import Any, NamedTuple

from wildscav.words import WordsPlayer, WordsSeat

BOX = re.compile(
    r"^- box (\d+): (?:here|.*?, ([\d.]+) m)(?:, ([\d.]+) m (?:higher|lower))?, (\d+) supplies$", re.M
)
HEADING = re.compile(r"bearing (\d+)°")
WAVE = re.compile(r"^Wave (\d+): supplies (appeared|appear in) ([\d.]+) s .*?most within (\d+) m", re.M)
ENEMY = re.compile(r"^Agents in sight:\n- agent (\d+)[^\n]*, enemy: (?![^\n]*cannot be hurt)", re.M)
RICH = 8  # supplies: such boxes are worth more than a walk to a wave
HOT = 20.0  # m, greatest radius of a wave that is worth a walk
EARLY = 10.0  # s before a wave, at which it walks there
STOREY = 4.0  # m on foot for each metre up or down
START_UP = 3.0  # m, that every box costs besides


class Reader(WordsPlayer):
    """Walks to the target, or to the box that is worth most for its way; explores if there is none.

    Where it has a weapon, it first attacks the nearest enemy in sight.
    """

    def __init__(self) -> None:
        self.failed: dict[int, int] = {}  # tries of boxes that were not reached
        self.stuck = 0  # times in a row
        self.visited = 0  # the number of the last wave that it has been to
        self.goal = 0  # the number of the wave that it walks to

    def play(self, seat: WordsSeat) -> None:
        """Play on, and decide whenever a tool has ended."""
        text, ended = seat.observe(), ""
        while not seat.is_over:
            reply = seat.call(*self.decide(text, ended))
            text, ended = reply.text, reply.ended

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
        if "\nWeapon: " in text and (enemy := ENEMY.search(text)):
            return "attack", {"agent": int(enemy[1]), "seconds": 8.0}
        if " m OUTSIDE its edge" in text:
            return "go", {"place": "zone", "seconds": 5.0, "stop_for": ["enemy"]}
        if ended == "arrived" and f"\nWave {self.goal}: supplies appeared" in text:
            self.visited = max(self.visited, self.goal)
        boxes = self.boxes(text)
        wave = None if any(box.supplies >= RICH for box in boxes.values()) else self.wave(text)
        if wave is not None:
            return self.walk_to_wave(*wave, ended)
        if boxes:
            best = min(boxes, key=lambda number: boxes[number].effort)
            self.failed[best] = self.failed.get(best, 0) + 1
            return "go", {"box": best, "seconds": 3.0 + boxes[best].way / 4.0, "stop_for": []}
        return "explore", {"seconds": 5.0, "stop_for": ["box"]}

    def walk_to_wave(self, number: int, seconds: float, ended: str) -> tuple[str, dict[str, Any]]:
        """Return the call that leads to a wave, or waits there for it."""
        if ended == "arrived" and self.goal == number and seconds > 0.0:
            return "wait_until", {"event": "wave", "seconds": seconds + 0.5}
        self.goal = number
        return "go", {"place": f"wave {number}", "seconds": 5.0, "stop_for": ["box"]}

    def wave(self, text: str) -> tuple[int, float] | None:
        """Return a dense wave that has just appeared or soon will, and in how many s, unless it was there."""
        for number, tense, seconds, radius in WAVE.findall(text):
            left = 0.0 if tense == "appeared" else float(seconds)
            if left < EARLY and float(radius) <= HOT and int(number) > self.visited:
                return int(number), left
        return None

    def boxes(self, text: str) -> dict[int, "Box"]:
        """Return the boxes in a text that it did not fail to reach twice."""
        found = {
            int(number): Box(float(way or 0.0) + STOREY * float(height or 0.0), int(supplies))
            for number, way, height, supplies in BOX.findall(text)
        }
        return {number: box for number, box in found.items() if self.failed.get(number, 0) < 2}


class Box(NamedTuple):
    """A box of which it read."""

    way: float  # m on foot, about
    supplies: int

    @property
    def effort(self) -> float:
        """What it costs for its worth."""
        return (self.way + START_UP) / self.supplies**0.6

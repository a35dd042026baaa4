"""A mind that is a script: it plays all tracks by the texts of a seat of words alone, in place of a model.

It remembers nothing between requests, so any number of seats may share it.
"""

import re
from collections.abc import Iterable
from typing import Any, NamedTuple, TypeAlias

from tests.scripted_model import Messages, Said, called

TIME = re.compile(r"^Time: [\d.]+ s of ", re.M)
ENEMY = re.compile(r"^- agent (\d+)[^:]*, enemy: (?:here|.*?, ([\d.]+) m)(?!.* s ago$)", re.M)
ROUNDS = re.compile(r"^Weapon: (\d+) rounds in the clip, (\d+) spare", re.M)
BOX = re.compile(r"^- box (\d+): (?:here|.*?, ([\d.]+) m).*?, (\d+) supplies$", re.M)
HEADING = re.compile(r"^You: .*?bearing (\d+)°", re.M)
WAVE = re.compile(r"^Wave (\d+): supplies appear in ([\d.]+) s", re.M)
NEXT_ZONE = re.compile(r"^Next zone: radius (\d+) m around .*?, ([\d.]+) m", re.M)
SHOT_RANGE = 40.0  # m, within which enemies are attacked
SOON = 12.0  # s before a wave, from which on it walks there

Order: TypeAlias = tuple[str, dict[str, Any]]  # a tool and its arguments


class Box(NamedTuple):
    """A box of which a text tells."""

    number: int
    far: float  # m
    supplies: int


def mind(messages: Messages, tools: list[dict[str, Any]]) -> Said:
    """Answer a request with the call that is sensible after its last text."""
    name, arguments = order(last_text(messages), {tool["function"]["name"] for tool in tools})
    return called(name, **arguments)


def last_text(messages: Messages) -> str:
    """Return the last text of a seat in the messages, or "" if there is none."""
    texts = (text for message in reversed(messages) for text in texts_of(message.get("content")))
    return next((text for text in texts if TIME.search(text)), "")


def texts_of(content: object) -> Iterable[str]:
    """Return the texts of a message's content, without its pictures."""
    if isinstance(content, list):
        return [part["text"] for part in content if part.get("type") == "text"]
    return [content] if isinstance(content, str) else []


def order(text: str, tools: set[str]) -> Order:
    """Return what to do after a text."""
    first = text.partition("\n")[0]
    if "\nYou are dead" in text:
        return "wait_until", {"event": "respawn", "seconds": 10.0}
    if "OUTSIDE its edge" in text:
        return "go", {"place": "zone", "seconds": 15.0, "stop_for": []}
    if (enemy := enemy_near(text)) is not None and "attack" in tools:
        return "attack", {"agent": enemy, "seconds": 8.0}
    if ": stuck." in first:
        return past_what_is_in_the_way(text)
    if "\nTarget: " in text and "not found yet" not in text:
        return "go", {"place": "target", "seconds": 30.0, "stop_for": []}
    return to_supplies(text, tools) or to_zone(text) or ("explore", {"seconds": 12.0})


def enemy_near(text: str) -> int | None:
    """Return the seat of the nearest enemy in sight that is worth a shot."""
    rounds = ROUNDS.search(text)
    if rounds is None or rounds[1] == rounds[2] == "0":
        return None
    in_sight = text.partition("\nAgents in sight:\n")[2].partition("\nAgents seen before:")[0]
    for seat, far in ENEMY.findall(in_sight):
        if float(far or 0.0) < SHOT_RANGE:
            return int(seat)
    return None


def past_what_is_in_the_way(text: str) -> Order:
    """Return a walk to one of three sides; which one, the moment decides."""
    heading = HEADING.search(text)
    off = (90, 180, 270)[len(text) % 3]
    bearing = ((int(heading[1]) if heading else 0) + off) % 360
    return "go", {"bearing": bearing, "seconds": 2.0, "stop_for": []}


def to_supplies(text: str, tools: set[str]) -> Order | None:
    """Return the call that fetches the box that is worth most for its way, or goes where supplies appear."""
    first = text.partition("\n")[0]
    if "pick_up" not in tools or (first.startswith("pick_up ended") and ": out_of_time." in first):
        return None
    boxes = [Box(int(number), float(far or 0.0), int(worth)) for number, far, worth in BOX.findall(text)]
    if boxes:
        best = min(boxes, key=lambda box: (box.far + 3.0) / box.supplies**0.6)
        return "pick_up", {"box": best.number, "seconds": min(60.0, 5.0 + best.far / 4.0)}
    waves = [(float(seconds), number) for number, seconds in WAVE.findall(text)]
    if waves and min(waves)[0] < SOON and ": arrived." not in first:
        return "go", {"place": f"wave {min(waves)[1]}", "seconds": 8.0, "stop_for": ["box"]}
    return None


def to_zone(text: str) -> Order | None:
    """Return the walk into the next zone, if the seat is outside of it."""
    zone = NEXT_ZONE.search(text)
    if zone is None or float(zone[2]) < 0.7 * float(zone[1]):
        return None
    return "go", {"place": "zone", "seconds": 10.0}

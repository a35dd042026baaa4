"""What a seat senses, as text: the same observations always give the same bytes."""

from collections.abc import Iterable, Sequence

from wildscav.agent import Observation, SupplyBox
from wildscav.geometry import direction_to, distance, flat_distance, turn_to
from wildscav.skills.zone import safe_zone
from wildscav_language.body import Body
from wildscav_language.memory import Seen
from wildscav_language.phrases import compass, degrees, way_to
from wildscav_language.surroundings import around, in_view

LIMIT = 8000  # bytes of a text at most
# Lines of each list; what is nearest comes first, of agents out of sight who was seen last.
MOST = {"Boxes": 24, "Boxes out of sight": 16, "Agents in sight": 16, "Agents seen before": 8, "Teammates": 8}
MOST_EVENTS = 10
MOST_NUMBERS = 12  # of boxes that are new or gone
MOST_PLACES = 20
MOST_WAVES = 4
IS_HOUSE = ", a building"
FACING = 20.0  # degrees off this seat, within which an agent faces it


def describe(body: Body) -> str:
    """Return the text of now, and note what was told."""
    now = body.now
    parts = [_time(body), _own_state(body)]
    parts += [_changes(body)] if body.told is not None else []
    if now.alive:
        parts += [*_goals(body), *_boxes(body), *_agents(body), *_teammates(body)]
        parts += [around(body), in_view(body), _places(body)]
    body.told, body.told_boxes = now, frozenset(body.memory.boxes)
    return bounded("\n".join(part for part in parts if part))


def bounded(text: str) -> str:
    """Return a text of ``LIMIT`` bytes at most; what does not fit is left out at the end."""
    if len(text.encode()) <= LIMIT:
        return text
    tail = "\n(more left out)"
    head = text.encode()[: LIMIT - len(tail)].decode(errors="ignore")
    return head[: head.rfind("\n")] + tail


def _time(body: Body) -> str:
    now, match = body.now, body.match
    return f"Time: {now.time:.1f} s of {match.time_limit:g} s, step {now.step}."


def _own_state(body: Body) -> str:
    now, match = body.now, body.match
    if not now.alive:
        back = f"you come back in {now.respawn_in:.1f} s" if match.respawns else "you are out of the match"
        return f"You are dead: {back}."
    x, y, z = now.position
    parts = [
        f"You: health {now.health} of {match.start_health}",
        f"at x {x:.1f} (east), z {z:.1f} (north), height {y:.1f} m",
        f"facing {compass(now.yaw)}, bearing {degrees(now.yaw)}",
        "inside a building" if body.gathering.roofed else "outdoors",
    ]
    parts += ["in water"] if now.in_water else []
    parts += ["in the air"] if not (now.on_ground or now.in_water) else []
    parts += [f"nobody can hurt you for {now.invincible_in:.1f} s"] if now.invincible else []
    return f"{', '.join(parts)}.{_equipment(body)}"


def _equipment(body: Body) -> str:
    """Return what the seat carries, on tracks that have it."""
    now, text = body.now, ""
    if body.is_armed:
        text += f"\nWeapon: {now.clip} rounds in the clip, {now.spare_ammo} spare"
        text += f", reloaded in {now.reload_in:.1f} s" if now.reloading else ""
        fire = ", you hold your fire" if body.holds_fire else ", you shoot at enemies in sight"
        text += "." if body.match.senses == "pixels" else f"{fire}."
    if body.gathers:
        text += f"\nSupplies: you carry {now.supplies}, your team {now.team_supplies}."
        text += " A box is within reach." if now.can_pick_up else ""
    return text


def _changes(body: Body) -> str:
    """Return what has changed since the last text."""
    now, before = body.now, body.told
    if before is None or now.step == before.step:
        return "Since the last text: nothing, no time has passed."
    walked = flat_distance(before.position, now.position)
    changes = [f"{now.time - before.time:.1f} s have passed"]
    changes.append(f"you are {walked:.1f} m from where you were")
    if now.health != before.health:
        changes.append(f"your health changed by {now.health - before.health:+d}")
    if now.supplies != before.supplies:
        changes.append(f"your supplies changed by {now.supplies - before.supplies:+d}")
    boxes = body.memory.boxes.keys()
    changes += _numbers("new boxes", boxes - body.told_boxes) + _numbers(
        "boxes gone", body.told_boxes - boxes
    )
    lines = [f"Since the last text: {', '.join(changes)}."]
    events = [event for event in body.memory.events if event.time > before.time]
    lines += [f"- {event.time:.1f} s: {event.text}" for event in events[-MOST_EVENTS:]]
    lines += [f"- and {len(events) - MOST_EVENTS} earlier"] if len(events) > MOST_EVENTS else []
    return "\n".join(lines)


def _numbers(what: str, boxes: Iterable[int]) -> list[str]:
    """Return what became of boxes; nothing if there are none."""
    found = sorted(boxes)
    more = f" and {len(found) - MOST_NUMBERS} more" if len(found) > MOST_NUMBERS else ""
    return [f"{what} {' '.join(map(str, found[:MOST_NUMBERS]))}{more}"] if found else []


def _goals(body: Body) -> list[str]:
    """Return where target, zone and waves of supplies are."""
    now, match = body.now, body.match
    lines: list[str] = []
    if now.target is not None:
        lines.append(f"Target: {way_to(now.position, now.yaw, now.target)}.")
    elif match.track == "capture":
        lines.append("Target: not found yet; come within about 20 m of it.")
    lines += _zone(now)
    return [*lines, *_waves(body)]


def _waves(body: Body) -> list[str]:
    """Return where supplies appeared last, and where they will appear next."""
    now, begun = body.now, body.waves_begun
    first = max(0, begun - 1)
    lines = []
    for number, wave in enumerate(body.match.supply_waves[first : begun + MOST_WAVES], start=first + 1):
        way = way_to(now.position, now.yaw, (wave.center[0], now.position[1], wave.center[1]))
        when = f"appear in {wave.time - now.time:.1f} s"
        if wave.time <= now.time:
            when = f"appeared {now.time - wave.time:.1f} s ago"
        lines.append(f"Wave {number}: supplies {when} around {way}, most within {wave.radius:.0f} m.")
    return lines


def _zone(now: Observation) -> list[str]:
    """Return where the safe zone is."""
    reading = now.tensors.get("zone")
    if reading is None or not reading[0]:
        return []
    zone = safe_zone(now)
    depth = zone.now.depth(now.position)
    where = f"{depth:.0f} m inside its edge" if depth >= 0.0 else f"{-depth:.0f} m OUTSIDE its edge"
    shrinks, shrunk, damage = (float(reading[column]) for column in (8, 9, 10))
    way = way_to(now.position, now.yaw, zone.next.center)
    return [
        f"Safe zone: you are {where}; outside you lose {damage:g} health a second.",
        f"Next zone: radius {zone.next.radius:.0f} m around {way}.",
        f"The zone begins to shrink to it in {shrinks:.0f} s, and has shrunk in {shrunk:.0f} s.",
    ]


def _boxes(body: Body) -> list[str]:
    """Return the boxes that the seat senses, and those that it remembers; nearest first."""
    now, known = body.now, body.memory.boxes
    listed = {box.id for box in now.supply_boxes}
    ordered = sorted(known.values(), key=lambda box: (distance(now.position, box.position), box.id))
    sensed = [_box(body, box) for box in ordered if box.id in listed]
    remembered = [_box(body, box) for box in ordered if box.id not in listed]
    return [*_listing("Boxes", sensed), *_listing("Boxes out of sight", remembered)]


def _box(body: Body, box: SupplyBox) -> str:
    way = way_to(body.now.position, body.now.yaw, box.position)
    return f"- box {box.id}: {way}, {box.quantity} supplies"


def _agents(body: Body) -> list[str]:
    """Return the agents in sight, and where others were seen last."""
    now, memory = body.now, body.memory
    in_sight = [_agent(body, Seen(now.time, agent)) for agent in now.agents]
    shown = {agent.seat for agent in now.agents}
    gone = sorted((seen for seat, seen in memory.agents.items() if seat not in shown), key=lambda s: -s.time)
    before = [f"{_agent(body, seen)}, {now.time - seen.time:.1f} s ago" for seen in gone]
    return [*_listing("Agents in sight", in_sight), *_listing("Agents seen before", before)]


def _agent(body: Body, seen: Seen) -> str:
    now, agent = body.now, seen.agent
    side = "of your team" if agent.team == body.match.team else "enemy"
    off = turn_to(agent.yaw, direction_to(agent.position, now.position))
    parts = [way_to(now.position, now.yaw, agent.position)]
    parts.append("faces you" if abs(off) < FACING else f"faces {compass(agent.yaw)}")
    if body.match.senses == "original":
        speed = flat_distance((0.0, 0.0, 0.0), agent.velocity)
        parts.append(f"health {agent.health}")
        parts.append(
            f"walks {compass(direction_to((0.0, 0.0, 0.0), agent.velocity))} at {speed:.0f} m/s"
            if speed >= 0.5
            else "stands"
        )
    parts += ["cannot be hurt now"] if agent.invincible else []
    return f"- {body.memory.name_of(agent.seat)}, {side}: {', '.join(parts)}"


def _teammates(body: Body) -> list[str]:
    """Return where the teammates are, in sight or not."""
    now, lines = body.now, []
    x, y, z = now.position
    for row in now.tensors.get("teammates", ()):
        if not row[0]:
            continue
        east, up, north = (float(number) for number in row[2:5])
        way = way_to(now.position, now.yaw, (x + east, y + up, z + north))
        state = f"health {row[10]:.0f}" if row[10] else "dead"
        carries = f", carries {row[12]:.0f} supplies" if body.gathers else ""
        lines.append(f"- {body.memory.name_of(int(row[1]))}: {way}, {state}{carries}")
    return _listing("Teammates", lines)


def _listing(title: str, lines: Sequence[str]) -> list[str]:
    """Return a list under its title, as long as it may be; nothing if it is empty."""
    most = MOST[title]
    if not lines:
        return []
    more = [f"- and {len(lines) - most} more"] if len(lines) > most else []
    return [f"{title}:", *lines[:most], *more]


def _places(body: Body) -> str:
    """Return where the places with names are."""
    now = body.now
    places = [(name, place) for name, place in body.memory.places().items() if name != "target"]
    ordered = sorted(places, key=lambda one: flat_distance(now.position, one[1]))
    lines = [
        f"- {name}{IS_HOUSE * name.startswith('place')}: {way_to(now.position, now.yaw, place)}"
        for name, place in ordered[:MOST_PLACES]
    ]
    return "\n".join(["Places:", *lines]) if lines else ""

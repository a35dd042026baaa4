"""The display over a picture: what the page of a person who plays says about their own seat.

Everything is drawn with whole numbers, so the same state gives the same pixels on any machine. The colours of
the marks occur nowhere else in the display, so that agents may look for them.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import arctangent, cosine, sine, wrap
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.compilation.tables.array_tables import Addresses
from wildscav_engine.sensors.screen.letters import (
    ADVANCE,
    HEIGHT,
    WIDTH,
    Picture,
    digits_of,
    fill,
    letters_of,
    shade,
    word,
    write_letter,
    write_number,
    write_word,
)
from wildscav_engine.simulation.state import (
    NOBODY,
    NOT_ELIMINATED,
    Agents,
    Matches,
    agents_at,
    matches_at,
    supplies_at,
)
from wildscav_engine.simulation.systems.zone import phase_at, zone_at
from wildscav_engine.specs.rules import FRAMES_PER_SECOND

VIEW = 130.0  # degrees that the compass shows
MOST_BOXES = 8  # that it shows, the nearest ones
LINE = HEIGHT + 2  # pixels of a line of text at scale 1
FEW_ROUNDS = 3
WHITE, DIM, RED = 0xFFFFFF, 0x9AA4A8, 0xFF4040
GOLD, SKY, RING = 0xFFCC33, 0x9FE8FF, 0x40FFA0  # the target, boxes, the next safe zone
GREEN = 0x50D070
POINTS = np.array([word(text) for text in ("N", "NE", "E", "SE", "S", "SW", "W", "NW")], np.int64)
LOZENGE, BOX, CIRCLE = word("*"), word("="), word("O")
COLON, SLASH, POINT, CROSS = word(":"), word("/"), word("."), word("+")
METRES, SECONDS = word("M"), word(" S")
DEAD, OUT, BACK_IN, SAFE = word("DEAD"), word("OUT"), word("BACK IN "), word("SAFE ")
RELOAD, EMPTY, PICK_UP = word("RELOAD "), word("EMPTY"), word("PICK UP")
INSIDE, OUTSIDE = word("ZONE "), word("OUT ")


@kernel
def draw_displays(
    agent_table: Addresses,
    supply_table: Addresses,
    match_table: Addresses,
    boxes: NDArray[np.int32],
    others: NDArray[np.int32],
    can_pick_up: NDArray[np.bool_],
    seats: NDArray[np.int64],
    has_weapon: bool,
    has_supplies: bool,
    pictures: NDArray[np.uint8],
) -> None:
    """Draw the displays of S seats in each of B matches over their pictures.

    Args:
        boxes: (B, A, boxes) slots of the boxes that each agent sees, nearest first, or -1.
        others: (B, A, agents) seats of the agents that it sees, or NOBODY.
        can_pick_up: (B, A) whether a box is in its reach.
        seats: (S,) their numbers.
        has_weapon: Whether agents shoot on this track.
        has_supplies: Whether they pick up supplies.
        pictures: (B, S, H, W, 3), drawn over.
    """
    agents, matches = agents_at(agent_table), matches_at(match_table)
    places = supplies_at(supply_table).position
    for match in range(pictures.shape[0]):
        for index in range(seats.shape[0]):
            seat, picture = seats[index], pictures[match, index]
            scale = max(1, min(picture.shape[1] // 240, picture.shape[0] // 150))
            _draw_hurt(picture, scale, agents, match, seat, others[match, seat])
            _draw_clock(picture, scale, matches.frame_limit[match] - matches.frame[match])
            _draw_compass(picture, scale, agents.yaw[match, seat])
            _draw_boxes(picture, scale, agents, match, seat, places[match], boxes[match, seat])
            _draw_target(picture, scale, agents, matches, match, seat)
            _draw_zone(picture, scale, agents, matches, match, seat)
            _draw_health(picture, scale, agents.health[match, seat], agents.full_health[match, seat])
            if has_supplies:
                _draw_supplies(picture, scale, agents.supplies[match, seat])
            if has_weapon:
                _draw_weapon(picture, scale, agents, match, seat)
            _draw_state(picture, scale, agents, match, seat, has_weapon, can_pick_up[match, seat])


@kernel
def _draw_hurt(
    picture: Picture, scale: int, agents: Agents, match: int, seat: int, others: NDArray[np.int32]
) -> None:
    """Draw a red frame around the picture of a seat that was hit, and an arc towards a shooter in sight."""
    shooter = agents.hit_by_seat[match, seat]
    if shooter == NOBODY:
        return
    height, width, wide = picture.shape[0], picture.shape[1], 3 * scale
    fill(picture, 0, 0, width, wide, RED)
    fill(picture, 0, height - wide, width, wide, RED)
    fill(picture, 0, 0, wide, height, RED)
    fill(picture, width - wide, 0, wide, height, RED)
    for place in range(others.shape[0]):
        if others[place] == shooter:
            east, north = _way(agents, match, seat, agents.position[match, shooter])
            angle = arctangent(east, north) - agents.yaw[match, seat]
            for dot in range(-10, 11):
                across, up = sine(angle + 2.0 * dot), cosine(angle + 2.0 * dot)
                column = width // 2 + int(np.floor(across * height / 4.0))
                row = height // 2 - int(np.floor(up * height / 4.0))
                fill(picture, column, row, 2 * scale, 3 * scale, RED)


@kernel
def _way(agents: Agents, match: int, seat: int, place: NDArray[np.float64]) -> tuple[float, float]:
    """Return the way to a place, m east and m north."""
    return place[0] - agents.position[match, seat, 0], place[2] - agents.position[match, seat, 2]


@kernel
def _draw_clock(picture: Picture, scale: int, frames: int) -> None:
    """Draw the time that is left, in minutes and seconds, at the top left."""
    seconds = (max(0, frames) + FRAMES_PER_SECOND - 1) // FRAMES_PER_SECOND
    shade(picture, 0, 0, ((digits_of(seconds // 60) + 3) * ADVANCE + 2) * scale, LINE * scale)
    left = write_number(picture, 2 * scale, scale, seconds // 60, scale, WHITE)
    left = write_word(picture, left, scale, COLON, scale, WHITE)
    left = write_letter(picture, left, scale, seconds % 60 // 10, scale, WHITE)
    write_letter(picture, left, scale, seconds % 10, scale, WHITE)


@kernel
def _draw_compass(picture: Picture, scale: int, yaw: float) -> None:
    """Draw a strip with the directions around the yaw, from 65° to the left to 65° to the right."""
    width = picture.shape[1]
    shade(picture, width // 4, 0, width // 2, 2 * LINE * scale)
    for step in range(24):
        away = wrap(15.0 * step - yaw)
        if abs(away) >= VIEW / 2.0:
            continue
        column = _column(picture, away)
        if step % 3 != 0:
            fill(picture, column, 4 * scale, scale, 2 * scale, DIM)
            continue
        text = POINTS[step // 3]
        half = letters_of(text) * ADVANCE * scale // 2
        if width // 4 <= column - half and column + half <= width - width // 4:
            write_word(picture, column - half, scale, text, scale, WHITE)


@kernel
def _column(picture: Picture, away: float) -> int:
    """Return the column of a direction in the compass, degrees to the right of the view."""
    half = picture.shape[1] // 2
    return int(half + np.floor(away * half / VIEW + 0.5))


@kernel
def _draw_mark(picture: Picture, scale: int, away: float, sign: int, color: int) -> None:
    """Draw a mark under the directions of the compass, at its end if it does not reach so far."""
    reach = 0.48 * VIEW
    column = _column(picture, min(reach, max(-reach, wrap(away))))
    write_word(picture, column - WIDTH // 2 * scale, LINE * scale, sign, scale, color)


@kernel
def _draw_boxes(
    picture: Picture,
    scale: int,
    agents: Agents,
    match: int,
    seat: int,
    places: NDArray[np.float32],
    boxes: NDArray[np.int32],
) -> None:
    """Mark the nearest boxes in the compass, as far as it reaches."""
    for place in range(MOST_BOXES):
        if boxes[place] < 0:
            return
        east = places[boxes[place], 0] - agents.position[match, seat, 0]
        north = places[boxes[place], 2] - agents.position[match, seat, 2]
        away = wrap(arctangent(east, north) - agents.yaw[match, seat])
        if abs(away) < 0.48 * VIEW:
            column = _column(picture, away)
            fill(picture, column - scale, (LINE + 3) * scale, 3 * scale, 3 * scale, SKY)


@kernel
def _draw_target(
    picture: Picture, scale: int, agents: Agents, matches: Matches, match: int, seat: int
) -> None:
    """Mark a known target in the compass, and write how far it is at the top right."""
    if not (matches.has_target[match] and agents.knows_target[match, seat]):
        return
    east, north = _way(agents, match, seat, matches.target[match])
    _draw_mark(picture, scale, arctangent(east, north) - agents.yaw[match, seat], LOZENGE, GOLD)
    _write_metres(picture, scale, 0, LOZENGE, int(np.sqrt(east * east + north * north) + 0.5), WHITE)


@kernel
def _write_metres(picture: Picture, scale: int, line: int, text: int, metres: int, color: int) -> None:
    """Write a word and a distance at the right end of a line, counted from the top."""
    width = (letters_of(text) + digits_of(metres) + 1) * ADVANCE * scale
    left, top = picture.shape[1] - scale - width, line * LINE * scale
    shade(picture, left - scale, top, width + 2 * scale, LINE * scale)
    left = write_word(picture, left, top + scale, text, scale, color)
    left = write_number(picture, left, top + scale, metres, scale, color)
    write_word(picture, left, top + scale, METRES, scale, color)


@kernel
def _draw_zone(picture: Picture, scale: int, agents: Agents, matches: Matches, match: int, seat: int) -> None:
    """Write how far inside or outside the safe zone the agent is, and mark where it shrinks to."""
    phase = phase_at(matches, match, matches.frame[match])
    if phase < 0:
        return
    zone = zone_at(matches, match, matches.frame[match])
    x, z = agents.position[match, seat, 0], agents.position[match, seat, 2]
    inside = zone.radius - np.sqrt((zone.x - x) * (zone.x - x) + (zone.z - z) * (zone.z - z))
    text, color = (INSIDE, WHITE) if inside >= 0.0 else (OUTSIDE, RED)
    _write_metres(picture, scale, 2, text, int(abs(inside)), color)
    bearing = arctangent(matches.zone[match, phase, 5] - x, matches.zone[match, phase, 6] - z)
    _draw_mark(picture, scale, bearing - agents.yaw[match, seat], CIRCLE, RING)


@kernel
def _draw_health(picture: Picture, scale: int, health: int, full: int) -> None:
    """Draw the health as a number with a bar above it, at the bottom left."""
    top, color = picture.shape[0] - LINE * scale, RED if 10 * health <= 3 * full else WHITE
    bar = 4 * ADVANCE * scale
    shade(picture, 0, top - 3 * scale, bar + 3 * scale, (LINE + 3) * scale)
    fill(picture, 2 * scale, top - 2 * scale, bar * min(health, full) // full, 2 * scale, GREEN)
    left = write_word(picture, 2 * scale, top + scale, CROSS, scale, color)
    write_number(picture, left, top + scale, health, scale, color)


@kernel
def _draw_supplies(picture: Picture, scale: int, supplies: int) -> None:
    """Write the supplies that are carried, in the middle at the bottom."""
    width = (1 + digits_of(supplies)) * ADVANCE * scale
    left, top = (picture.shape[1] - width) // 2, picture.shape[0] - LINE * scale
    shade(picture, left - scale, top, width + scale, LINE * scale)
    left = write_word(picture, left, top + scale, BOX, scale, SKY)
    write_number(picture, left, top + scale, supplies, scale, WHITE)


@kernel
def _draw_weapon(picture: Picture, scale: int, agents: Agents, match: int, seat: int) -> None:
    """Draw the crosshair, and at the bottom right the rounds or how long it still reloads."""
    _draw_crosshair(picture, scale, agents.hit_seat[match, seat] != NOBODY)
    clip, spare = agents.clip[match, seat], agents.spare_ammo[match, seat]
    tenths = (agents.reload_left[match, seat] * 10 + FRAMES_PER_SECOND - 1) // FRAMES_PER_SECOND
    letters = digits_of(clip) + 1 + digits_of(spare)
    if tenths > 0:
        letters = letters_of(RELOAD) + digits_of(tenths // 10) + 2
    width, top = letters * ADVANCE * scale, picture.shape[0] - LINE * scale
    left = picture.shape[1] - scale - width
    shade(picture, left - scale, top, width + 2 * scale, LINE * scale)
    color = RED if clip <= FEW_ROUNDS else WHITE
    if tenths > 0:
        left = write_word(picture, left, top + scale, RELOAD, scale, color)
        clip, spare = tenths // 10, tenths % 10
    left = write_number(picture, left, top + scale, clip, scale, color)
    left = write_word(picture, left, top + scale, POINT if tenths > 0 else SLASH, scale, color)
    write_number(picture, left, top + scale, spare, scale, color)


@kernel
def _draw_crosshair(picture: Picture, scale: int, hits: bool) -> None:
    """Draw four strokes around the middle, longer ones in red in the step of a hit."""
    x, y = picture.shape[1] // 2, picture.shape[0] // 2
    long, color = (5 * scale, RED) if hits else (3 * scale, WHITE)
    fill(picture, x, y - 2 * scale - long, scale, long, color)
    fill(picture, x, y + 3 * scale, scale, long, color)
    fill(picture, x - 2 * scale - long, y, long, scale, color)
    fill(picture, x + 3 * scale, y, long, scale, color)


@kernel
def _draw_state(
    picture: Picture, scale: int, agents: Agents, match: int, seat: int, has_weapon: bool, can_pick_up: bool
) -> None:
    """Write what matters most below the middle: death, protection, an empty weapon or a box in reach."""
    returns, safe = agents.respawn_left[match, seat], agents.invincible_left[match, seat]
    if agents.health[match, seat] <= 0:
        is_out = agents.eliminated[match, seat] != NOT_ELIMINATED or returns <= 0
        _say(picture, 2 * scale, 2, OUT if is_out else DEAD, 0, RED)
        if not is_out:
            _say(picture, scale, 3, BACK_IN, _seconds(returns), WHITE)
    elif safe > 0:
        _say(picture, scale, 3, SAFE, _seconds(safe), WHITE)
    elif has_weapon and agents.clip[match, seat] == 0 and agents.reload_left[match, seat] == 0:
        _say(picture, scale, 3, EMPTY, 0, RED)
    elif can_pick_up:
        _say(picture, scale, 3, PICK_UP, 0, SKY)


@kernel
def _seconds(frames: int) -> int:
    return int((frames + FRAMES_PER_SECOND - 1) // FRAMES_PER_SECOND)


@kernel
def _say(picture: Picture, scale: int, fifth: int, text: int, seconds: int, color: int) -> None:
    """Write a word and some seconds, unless 0, in the middle of a line some fifths of the height down."""
    letters = letters_of(text) + (digits_of(seconds) + letters_of(SECONDS) if seconds > 0 else 0)
    width, top = letters * ADVANCE * scale, picture.shape[0] * fifth // 5
    left = (picture.shape[1] - width) // 2
    shade(picture, left - scale, top, width + scale, LINE * scale)
    left = write_word(picture, left, top + scale, text, scale, color)
    if seconds > 0:
        left = write_number(picture, left, top + scale, seconds, scale, color)
        write_word(picture, left, top + scale, SECONDS, scale, color)

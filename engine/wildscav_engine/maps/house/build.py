"""Building the convex solids of a house from its plan."""

from wildscav_engine.geometry.world import Kind, Solid
from wildscav_engine.maps.house.box_builder import RAILING, Builder
from wildscav_engine.maps.house.plan import SLAB, STOREY_HEIGHT, HousePlan, Side, Stairs
from wildscav_engine.maps.house.roof import build_roofs
from wildscav_engine.maps.settlements.houses import House
from wildscav_engine.maps.settlements.houses import Room as MapRoom
from wildscav_engine.maps.settlements.sites import Site

FLOOR_LIFT = 0.08  # m of the ground floor above the levelled ground
FOUNDATION = 0.5  # m that the house reaches into the ground


def build_house(plan: HousePlan, site: Site) -> list[Solid]:
    """Return all solids of a house."""
    builder = Builder(site.pose, site.ground + FLOOR_LIFT)
    for level, storey in enumerate(plan.storeys):
        floor = level * STOREY_HEIGHT
        foundation = FOUNDATION if level == 0 else 0.0
        for wall in storey.outer:
            builder.wall(wall, floor, floor - foundation, floor + STOREY_HEIGHT)
        for wall in storey.inner:
            builder.wall(wall, floor, floor, floor + STOREY_HEIGHT - SLAB)
        for number, wing in enumerate(plan.wings):
            if level < wing.storeys:
                hole = storey.hole if number == 0 else None
                builder.floor(wing.inside, hole, floor - (foundation or SLAB), floor)
        if storey.stairs:
            builder.stairs(storey.stairs, floor, hangs=level > 0)
        if plan.stairs:
            _build_guards(builder, plan.stairs, level, floor, goes_on=storey.stairs is not None)
        for piece in storey.furniture:
            for block in piece.blocks:
                builder.block(Kind.FURNITURE, block.area, floor + block.bottom, floor + block.top)
    roofs = build_roofs(builder, plan)
    return builder.solids() + roofs


def _build_guards(builder: Builder, stairs: Stairs, level: int, floor: float, *, goes_on: bool) -> None:
    """Build the wall or railing beside flights, and the railing at a well from which no stairs lead on."""
    if stairs.landing:
        top = STOREY_HEIGHT if goes_on else RAILING
        builder.block(Kind.WALL, stairs.spine, floor, floor + top)
    elif level > 0:
        builder.block(Kind.WALL, stairs.spine, floor, floor + RAILING)
    if not goes_on:
        builder.block(Kind.WALL, stairs.foot, floor, floor + RAILING)


def doorsteps(plan: HousePlan, site: Site, distance: float) -> list[tuple[float, float]]:
    """Return x and z in m of the place in front of each outer doorway, ``distance`` m from the wall."""
    places = []
    for (across, along), side in plan.doors:
        away = distance if side in (Side.FRONT, Side.RIGHT) else -distance
        place = (across, along + away) if side.is_across else (across + away, along)
        places.append(site.pose.outside(*place))
    return places


def house_of(plan: HousePlan, site: Site) -> House:
    """Return the house of a map for a plan on a site."""
    return House(
        center=(site.pose.x, site.pose.z),
        size=plan.size,
        yaw=site.yaw,
        ground=site.ground + FLOOR_LIFT,
        storeys=len(plan.storeys),
        storey_height=STOREY_HEIGHT,
        wings=tuple(wing.outline for wing in plan.wings),
        rooms=tuple(
            MapRoom(level, room.area) for level, storey in enumerate(plan.storeys) for room in storey.rooms
        ),
    )

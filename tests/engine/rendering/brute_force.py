"""A brute-force ray tracer over the triangles of the exported meshes: slow, short, and without any kernel.

Möller & Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", Journal of Graphics Tools 1997. All rays
of one image start at one eye, so everything that does not depend on their direction is computed once per
triangle.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.geometry.world import World, build_world
from wildscav_engine.maps.export.mesh import Mesh, solids_mesh, terrain_mesh, water_mesh
from wildscav_engine.rendering.hits import WATER_HIT
from wildscav_engine.rendering.tracing.solids import Solids

RAYS_AT_ONCE = 64  # so that their tables stay in the processor's cache
ON_EDGE = 1e-9  # how far outside a triangle, in shares of it, a ray still meets it
TURNS = (1e-6, 1e-5, 1e-4)  # rad, by which a ray is rotated to test its immediate neighbourhood
NEAR_SURFACE = 1e-4  # m; nearer to the surface of a solid than this, an eye may be in it or not


class Surface(NamedTuple):
    """T triangles; those after ``static`` belong to moving solids."""

    corners: NDArray[np.float64]  # (T, 3, 3) m
    middles: NDArray[np.float64]  # (T, 3) m
    radius: NDArray[np.float64]  # (T,) m, of the sphere around the middle that holds a triangle
    normals: NDArray[np.float64]  # (T, 3) outwards, unit
    solids: NDArray[np.int64]  # (T,) as Hits.solid has them
    low: NDArray[np.float64]  # (2,) m, x and z of the map's south-west corner
    high: NDArray[np.float64]  # (2,) m, of its north-east corner
    static: int  # solids of the world


class Met(NamedTuple):
    """What each of n rays hits."""

    distance: NDArray[np.float64]  # (n,) m, inf where nothing is met
    solid: NDArray[np.int64]  # (n,) as Hits.solid has them
    normal: NDArray[np.float64]  # (n, 3) outwards; 0 where nothing is met or at the eye, NaN if not known


def surface_of(world: World, moving: Solids | None = None, *, with_water: bool = False) -> Surface:
    """Return all triangles of a world and of its moving solids."""
    static = len(world.solid_kind)
    meshes = [(terrain_mesh(world), TERRAIN_HIT), (solids_mesh(world), 0)]
    if with_water:
        meshes.append((water_mesh(world), WATER_HIT))
    if moving is not None:
        meshes.append((solids_mesh(_world_of(moving)), static))
    corners = np.concatenate([mesh.vertices.astype(np.float64)[mesh.triangles] for mesh, _ in meshes])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1)
    real = length > 1e-12
    solids = np.concatenate([_named(mesh, first) for mesh, first in meshes])
    size = 2.0 * np.array(world.water.shape[::-1])
    corners, middles = corners[real], corners[real].mean(axis=1)
    return Surface(
        corners,
        middles,
        np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1) + 1e-6,
        normals[real] / length[real, None],
        solids[real],
        world.corner,
        world.corner + size,
        static,
    )


def _named(mesh: Mesh, first: int) -> NDArray[np.int64]:
    """Return the solid of each triangle, counted from ``first``; a negative number for none."""
    return np.where(mesh.solids >= 0, mesh.solids + first, first).astype(np.int64)


def _world_of(solids: Solids) -> World:
    """Return a world of only these solids, as far as the mesh export needs it."""
    empty = build_world((0.0, 0.0), np.zeros((2, 2)), np.zeros((1, 1)), [], np.zeros((0, 3)))
    return empty._replace(solid_kind=solids.kind, solid_start=solids.face_start, faces=solids.faces)


def meet(surface: Surface, eye: NDArray[np.float64], ways: NDArray[np.float64], far: float) -> Met:
    """Return what rays hit first.

    Args:
        surface: All triangles.
        eye: (3,) m, where all rays start.
        ways: (n, 3) unit vectors.
        far: m, beyond which nothing is met.
    """
    inside = containers(surface, eye, 0.0)
    if inside:
        return Met(np.zeros(len(ways)), np.full(len(ways), inside[0]), np.zeros((len(ways), 3)))
    return _meet_outside(surface, eye, ways, far)


def _meet_outside(surface: Surface, eye: NDArray[np.float64], ways: NDArray[np.float64], far: float) -> Met:
    """Return what rays hit first, for an eye outside all solids."""
    distance, solid = np.full(len(ways), np.inf), np.full(len(ways), NOTHING_HIT)
    normal = np.zeros((len(ways), 3))
    for first in range(0, len(ways), RAYS_AT_ONCE):
        some = ways[first : first + RAYS_AT_ONCE]
        tried = _in_cone(surface, eye, some, far)
        along = _crossings(surface, tried, eye, some)
        if not along.size:
            continue
        nearest = np.argmin(along, axis=1)
        met = np.flatnonzero(along[np.arange(len(some)), nearest] <= far)
        rays, triangles = first + met, tried[nearest[met]]
        distance[rays] = along[met, nearest[met]]
        solid[rays], normal[rays] = surface.solids[triangles], surface.normals[triangles]
    return Met(distance, solid, normal)


def _in_cone(
    surface: Surface, eye: NDArray[np.float64], ways: NDArray[np.float64], far: float
) -> NDArray[np.int64]:
    """Return the triangles with their fronts to an eye whose spheres touch a cone around some rays."""
    to_middle, radius = surface.middles - eye, surface.radius
    away = np.sqrt(_dot(to_middle, to_middle))
    axis = ways.mean(axis=0)
    axis /= max(1e-9, float(np.linalg.norm(axis)))
    half = np.arccos(np.clip(ways @ axis, -1.0, 1.0)).max() + 1e-6
    beside = np.arccos(np.clip(to_middle @ axis / np.maximum(away, 1e-12), -1.0, 1.0))
    spread = np.where(away > radius, np.arcsin(np.minimum(1.0, radius / np.maximum(away, 1e-12))), np.pi)
    front = _dot(surface.normals, eye - surface.corners[:, 0]) >= 0.0
    tried = front & (beside <= half + spread) & (away - radius <= far)
    if not _is_over_map(surface, eye):
        tried &= surface.solids >= surface.static
    return np.flatnonzero(tried)


def _crossings(
    surface: Surface, tried: NDArray[np.int64], eye: NDArray[np.float64], ways: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return (n, T) m along each ray to the front of each triangle that is tried, inf where it passes it."""
    a = surface.corners[tried, 0]
    ab, ac, to_eye = surface.corners[tried, 1] - a, surface.corners[tried, 2] - a, eye - a
    out = _cross(ab, ac)
    # The three products of Möller and Trumbore, with the direction taken out of each; b and c are shares of
    # the facing, so that nothing is divided by nothing.
    facing = ways @ -out.T  # positive towards the front
    b, c = ways @ _cross(ac, to_eye).T, ways @ _cross(to_eye, ab).T
    slack = ON_EDGE * facing
    met = (facing > 1e-14 * np.sqrt(_dot(out, out))) & (b >= -slack) & (c >= -slack)
    met &= b + c <= facing + slack
    above = _dot(out, to_eye)
    along = np.full(met.shape, np.inf)
    rays, triangles = np.nonzero(met)
    along[rays, triangles] = above[triangles] / facing[rays, triangles]
    return along


def _cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (n, 3) cross products; NumPy's own takes several times as long."""
    ax, ay, az, bx, by, bz = *a.T, *b.T
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=1)


def _dot(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.einsum("ij,ij->i", a, b))


def _is_over_map(surface: Surface, eye: NDArray[np.float64]) -> bool:
    return bool(np.all(eye[[0, 2]] >= surface.low) and np.all(eye[[0, 2]] < surface.high))


def containers(surface: Surface, eye: NDArray[np.float64], margin: float) -> list[int]:
    """Return the solids, as Hits.solid has them, that hold an eye or come within a margin in m of it.

    Below the ground is in the terrain.
    """
    outside = _dot(surface.normals, eye - surface.corners[:, 0])
    own = surface.solids >= 0
    names, group = np.unique(surface.solids[own], return_inverse=True)
    most = np.full(len(names), -np.inf)
    np.maximum.at(most, group, outside[own])
    found = [int(name) for name in names[most <= margin]]
    if not _is_over_map(surface, eye):
        return [name for name in found if name >= surface.static]
    return found + ([TERRAIN_HIT] if _is_below_ground(surface, eye, margin) else [])


def _is_below_ground(surface: Surface, eye: NDArray[np.float64], margin: float) -> bool:
    """Return whether the terrain is straight above, less a margin in m."""
    top = np.array([eye[0], surface.corners[:, :, 1].max() + 1.0, eye[2]])
    ground = np.flatnonzero(surface.solids == TERRAIN_HIT)
    away = _crossings(surface, ground, top, np.array([[0.0, -1.0, 0.0]])).min()
    return bool(eye[1] <= top[1] - float(away) + margin)


def a_hair_aside(way: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (720, 3) directions around one, enough for the wedges of six triangles that meet aslant."""
    helper = [0.0, 1.0, 0.0] if abs(way[1]) < 0.9 else [1.0, 0.0, 0.0]
    right = np.cross(helper, way)
    right /= np.linalg.norm(right)
    angles = np.arange(240)[:, None] * np.pi / 120
    around = np.cos(angles) * right + np.sin(angles) * np.cross(way, right)
    turned = np.concatenate([way + turn * around for turn in TURNS])
    unit: NDArray[np.float64] = turned / np.linalg.norm(turned, axis=1)[:, None]
    return unit


def disagreements(
    surface: Surface, eye: NDArray[np.float64], ways: NDArray[np.float64], far: float, answers: Met
) -> tuple[list[str], int]:
    """Compare results with brute force.

    A result that differs is accepted if a slightly rotated ray gives it: then the ray runs along an edge.

    Returns:
        The errors, one line per ray, and the number of different but accepted results.
    """
    truth = meet(surface, eye, ways, far)
    good = _agree(truth, answers, far)
    good |= (answers.distance <= NEAR_SURFACE) & np.isin(
        answers.solid, containers(surface, eye, NEAR_SURFACE)
    )
    if not containers(surface, eye, -NEAR_SURFACE):
        good |= _agree(_meet_outside(surface, eye, ways, far), answers, far)
    faults, along_edges = [], 0
    for ray in np.flatnonzero(~good):
        aside = a_hair_aside(ways[ray])
        answer = Met(*(np.repeat(part[ray : ray + 1], len(aside), axis=0) for part in answers))
        if _agree(_meet_outside(surface, eye, aside, far), answer, far).any():
            along_edges += 1
            continue
        faults.append(
            f"from {eye.tolist()} along {ways[ray].tolist()} (far {far}): solid {answers.solid[ray]} at "
            f"{answers.distance[ray]} m, normal {answers.normal[ray]}, not {truth.solid[ray]} at "
            f"{truth.distance[ray]} m, normal {truth.normal[ray]}"
        )
    return faults, along_edges


def _agree(truth: Met, answers: Met, far: float) -> NDArray[np.bool_]:
    """Return (n,) whether the hits are the same, within the precision of float32 meshes."""
    nearness = 1e-3 + 1e-4 * np.minimum(truth.distance, 1e4)
    with np.errstate(invalid="ignore"):
        near = (truth.distance == answers.distance) | (np.abs(truth.distance - answers.distance) <= nearness)
    same = (truth.solid == answers.solid) & near
    at_eye = (truth.distance == 0.0) | (truth.solid == NOTHING_HIT)
    turned = np.sum(truth.normal * answers.normal, axis=1) <= 0.9999  # False for a normal that is not known
    same &= at_eye | ~turned
    # What lies just at the end of the ray may be met or not.
    end = np.minimum(truth.distance, answers.distance)
    one_met = (truth.solid == NOTHING_HIT) != (answers.solid == NOTHING_HIT)
    return same | (one_met & (np.abs(end - far) <= 1e-3 + 1e-4 * far))

"""Check that depth maps agree with Embree, and explain the pixels that differ."""

from collections import Counter

import numpy as np
from benchmarks.report import Figure
from benchmarks.speed.embree import Mesh, Tracer, directions, rays_of
from numpy.typing import NDArray

from wildscav_engine.geometry.world import CELL
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.sensors import DepthCamera

CLOSE = 0.01  # m of planar depth
TURN = 1e-4  # rad, between a ray and its slightly turned copies
ON_SURFACE = 1e-3  # m between a hit and the plane of the triangle that the other tracer hits
REASONS = {
    "silhouette": "turned by 1e-4 rad, Embree's ray hits what ours hits",
    "grazing": "both hit the plane of one triangle, at so small an angle that rounding shifts the hit",
    "far": "both hit it at the end of the ray's reach",
    "leaves the map": "the hit is beyond the edge of the map, where ours finds nothing",
    "crack": "Embree's ray passes between two triangles; all rays around it hit what ours hits",
    "starts inside": "the eye is in a solid or below the ground, which the mesh does not show",
    "unexplained": "must be 0",
}


def check(
    game_map: GameMap,
    mesh: Mesh,
    tracer: Tracer,
    poses: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]],
    size: tuple[int, int],
    far: float,
) -> list[Figure]:
    """Compare the images of poses, (N, 3) m and twice (N,) degrees, and explain where they differ."""
    images = DepthCamera(*size, far).render(game_map, *poses)
    reasons: Counter[str] = Counter()
    for pose, image in zip(zip(*poses, strict=True), images, strict=True):
        position, yaw, pitch = pose
        pixel_directions = directions(yaw, pitch, *size)
        along = pixel_directions @ directions(yaw, pitch, 1, 1)[0]
        origins, rays = rays_of(position, yaw, pitch, *size)
        reach = np.full(len(pixel_directions), far, np.float32)
        theirs = np.asarray(tracer.distances(origins, rays, reach), np.float64)
        depth = np.where(theirs >= np.float32(far), far, theirs * along)
        for ray in np.flatnonzero(~(np.abs(image.reshape(-1) - depth) <= CLOSE)):
            case = _Difference(game_map, mesh, tracer, position, pixel_directions[ray], far)
            ours = min(far, float(image.reshape(-1)[ray] / along[ray]))
            ours = far if image.reshape(-1)[ray] >= far else ours
            reasons[case.reason(ours, float(theirs[ray]))] += 1
    pixels = images.size
    same = 1.0 - reasons.total() / pixels
    figures = [
        Figure("pixels compared", pixels, "", f"{len(images)} poses of {size[0]} × {size[1]}"),
        Figure(
            "within 1 cm of planar depth", 100.0 * same, "%", f"{reasons.total():,} differ; needed: 99.9 %"
        ),
    ]
    return figures + [
        Figure(f"differ: {name}", reasons[name], "pixels", said) for name, said in REASONS.items()
    ]


class _Difference:
    """A ray for which the two tracers give different distances."""

    def __init__(
        self,
        game_map: GameMap,
        mesh: Mesh,
        tracer: Tracer,
        eye: NDArray[np.float64],
        direction: NDArray[np.float64],
        far: float,
    ) -> None:
        self.world, self.mesh, self.tracer, self.eye, self.far = game_map.world, mesh, tracer, eye, far
        self.direction, self.turned = direction, _turned_slightly(direction)

    def reason(self, ours: float, theirs: float) -> str:
        """Return the reason why two distances in m differ: a key of REASONS."""
        if ours == 0.0:
            return "starts inside"
        if abs(ours - theirs) <= 2.0 * CLOSE and max(ours, theirs) >= self.far - CLOSE:
            return "far"
        if not self._over_map(min(ours, theirs)):
            return "leaves the map"
        if self._grazes(ours):
            return "grazing"
        # Only Embree traces more rays, so that a fault of ours cannot explain itself.
        theirs_turned = np.asarray(self._embree(self.turned, self.tracer.distances), np.float64)
        # Hits of slightly turned rays are so near to each other, on a surface not seen edge-on.
        near = np.abs(theirs_turned - ours) <= CLOSE + 2.0 * TURN * ours
        if near.all() and theirs > ours:
            return "crack"
        return "silhouette" if near.any() else "unexplained"

    def _over_map(self, distance: float) -> bool:
        size = CELL * np.array(self.world.water.shape[::-1])
        place = (self.eye + self.direction * distance)[[0, 2]] - self.world.corner
        return bool(np.all(place >= 0.0) and np.all(place <= size))

    def _grazes(self, ours: float) -> bool:
        """Return whether our hit lies on the plane of the triangle that Embree hits."""
        triangle = int(self._embree(self.direction[None], self.tracer.triangles)[0])
        if triangle < 0:
            return False
        a, b, c = self.mesh.vertices[self.mesh.triangles[triangle]].astype(np.float64)
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal)
        return bool(
            abs(normal @ self.direction) < 0.1
            and abs(normal @ (self.eye + self.direction * ours - a)) < ON_SURFACE
        )

    def _embree(self, rays: NDArray[np.float64], query: object) -> NDArray[np.generic]:
        reach = np.full(len(rays), self.far, np.float32)
        origins = np.tile(self.eye.astype(np.float32), (len(rays), 1))
        return query(origins, rays.astype(np.float32), reach)  # type: ignore[operator, no-any-return]


def _turned_slightly(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (4, 3) unit vectors: a direction turned slightly to the right, left, up and down."""
    helper = np.array([0.0, 1.0, 0.0]) if abs(direction[1]) < 0.9 else np.array([1.0, 0.0, 0.0])
    right = np.cross(helper, direction)
    right /= np.linalg.norm(right)
    up = np.cross(direction, right)
    turned = direction + TURN * np.array([right, -right, up, -up])
    unit: NDArray[np.float64] = turned / np.linalg.norm(turned, axis=1)[:, None]
    return unit

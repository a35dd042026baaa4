"""Labels of what each pixel shows: the kind of an object, or which one it is."""

from typing import Any

from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.geometry.world import Kind
from wildscav_engine.rendering.dynamic_objects import ObjectArrays
from wildscav_engine.rendering.trace import TracedImage
from wildscav_engine.rendering.tracing.frustum import nonnegative
from wildscav_engine.rendering.tracing.hit_buffer import NOTHING, is_terrain_code

FIRST_AGENT, FIRST_SOLID, FIRST_BOX = 10_000, 1_000_000, 1_000_000_000
NOTHING_LABEL, TERRAIN_LABEL, WATER_LABEL = int(Kind.NOTHING), int(Kind.TERRAIN), int(Kind.WATER)
AGENT = int(Kind.AGENT)


@inlined_kernel
def write_labels(
    traced: TracedImage, objects: ObjectArrays, first: int, by_instance: bool, image: NDArray[Any]
) -> None:
    """Write the label of what each ray of an image hits, the surface of water included.

    Args:
        by_instance: Whether objects of one kind have labels of their own: solids of the map from FIRST_SOLID
            on by index, agents from FIRST_AGENT on by seat, boxes from FIRST_BOX on by serial number. All
            other labels are a ``Kind``.
        image: (H, W) integers, written.
    """
    kinds, statics = traced.workspace.blocks.kinds, traced.solids.obbs.shape[0]
    for row in range(image.shape[0]):
        line, start = image[row], nonnegative(row * image.shape[1])
        mets = traced.buffer.met[start : start + line.shape[0]]
        for column in range(line.shape[0]):
            met = mets[column]
            if met < NOTHING:
                line[column] = TERRAIN_LABEL if is_terrain_code(met) else WATER_LABEL
            elif met == NOTHING:
                line[column] = NOTHING_LABEL
            elif met < statics:
                line[column] = FIRST_SOLID + traced.solids.names[met] if by_instance else kinds[met]
            else:
                line[column] = _label_of_object(objects, first + met - statics, by_instance)


@inlined_kernel
def _label_of_object(objects: ObjectArrays, index: int, by_instance: bool) -> int:
    kind = objects.kind[index]
    if not by_instance:
        return int(kind)
    return int(objects.instance[index]) + (FIRST_AGENT if kind == AGENT else FIRST_BOX)

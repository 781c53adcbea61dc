"""Three caves of one recipe, with data for machine learning: their sizes and start poses.

python examples/python/dataset.py
"""

import numpy as np
import plume

RECIPE = plume.Recipe({"graph": {"nodes": 12}, "mesh": {"voxel_m": 0.25}, "texture": {"size_px": 256}})


def main() -> None:
    """Makes the caves and prints the table."""
    print("seed  triangles  size m             start m                heading")
    for seed in range(3):
        with plume.generate(RECIPE, seed) as cave:
            print(f"{seed:4}  {row(cave)}")


def row(cave: plume.Cave) -> str:
    """Triangles, size of the box round all chunks, and the first start pose."""
    boxes, triangles = [], 0
    for chunk in cave.chunks:
        boxes.append(chunk.bounds)
        triangles += len(chunk.indices)
    size = np.max(boxes, axis=0)[1] - np.min(boxes, axis=0)[0]
    pose = cave.spawns[0]
    heading_deg = np.degrees(np.arctan2(pose[1, 0], pose[0, 0]))
    return f"{triangles:9}  {size.round(1)!s:17}  {pose[:3, 3].round(2)!s:21}  {heading_deg:.0f}°"


if __name__ == "__main__":
    main()

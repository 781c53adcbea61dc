"""How long it takes to author and save a chunk of a million vertices, compared with its arrays alone; seconds, best of five.

    python python/benches/write_chunk.py      (or: cargo xtask bench usd)

The lower bound is usd-core itself: the same arrays passed the same way into a bare layer and saved. For comparison, the
same bytes are written to a file without USD, neither copied nor compressed, with and without syncing to the disk.
"""

import importlib.util
import os
import resource
import tempfile
import time
from pathlib import Path

import numpy as np
from pxr import Sdf, Vt

SIDE = 1000
TRIES = 5
LEVEL = {"name": "LOD0", "error_m": 0.0, "extent": [[0, 0, 0], [50, 50, 1]], "parts": ["floor", "wall", "ceiling"]}
TEXTURES = {"base_color": "./base_color.png", "normal": "./normal.png", "orm": "./orm.png"}
USD_TYPES = {"points": "point3f[]", "normals": "normal3f[]", "st": "texCoord2f[]"}


def main():
    stage = load_stage()
    arrays = rough_floor()
    spec = {"textures": TEXTURES, "levels": [LEVEL]}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "chunk.usdc"
        alone = best(lambda: write_arrays(arrays, file), file)
        whole = best(lambda: stage.write_chunk({**spec, "path": str(file)}, dict(arrays)), file)
        size = file.stat().st_size
        raw = best(lambda: write_raw(arrays, file, wait=False), file)
        raw_disk = best(lambda: write_raw(arrays, file, wait=True), file)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    total = sum(array.nbytes for array in arrays.values())
    print(
        f"{len(arrays['LOD0.points'])} vertices, {total / 1e6:.0f} MB of arrays, {size / 1e6:.0f} MB file, peak {peak:.0f} MB"
    )
    print(f"author and save {whole:.3f} s, usd-core writing the arrays alone {alone:.3f} s, ratio {whole / alone:.2f}")
    print(f"the bytes without USD: {raw:.3f} s into the cache, {raw_disk:.3f} s synced to the disk")


def load_stage():
    """The module that the exporter runs."""
    path = Path(__file__).parents[2] / "exporters/stage.py"
    spec = importlib.util.spec_from_file_location("stage", path)
    stage = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(stage)
    return stage


def rough_floor():
    random = np.random.default_rng(1)
    x, y = np.meshgrid(*[np.arange(SIDE, dtype=np.float32) * 0.05] * 2)
    points = np.stack([x, y, random.random((SIDE, SIDE), dtype=np.float32)], -1).reshape(-1, 3)
    normals = random.standard_normal((SIDE * SIDE, 3)).astype(np.float32)
    corner = np.arange(SIDE * SIDE, dtype=np.int32).reshape(SIDE, SIDE)
    a, b, c, d = (part.ravel() for part in [corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1]])
    indices = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).ravel()
    part_of_face = random.integers(0, 3, len(indices) // 3)
    arrays = {
        "LOD0.points": points,
        "LOD0.normals": normals / np.linalg.norm(normals, axis=1, keepdims=True),
        "LOD0.st": random.random((SIDE * SIDE, 2), dtype=np.float32),
        "LOD0.indices": indices,
    }
    for number, part in enumerate(LEVEL["parts"]):
        arrays[f"LOD0.{part}"] = np.nonzero(part_of_face == number)[0].astype(np.int32)
    return arrays


def write_arrays(arrays, file):
    layer = Sdf.Layer.CreateNew(str(file))
    prim = Sdf.PrimSpec(layer, "Chunk", Sdf.SpecifierDef)
    for name, array in arrays.items():
        name = name.removeprefix("LOD0.")
        usd_type = Sdf.ValueTypeNames.Find(USD_TYPES.get(name, "int[]"))
        vt = {(2, 3): Vt.Vec3fArray, (2, 2): Vt.Vec2fArray, (1, array.shape[0]): Vt.IntArray}[
            array.ndim, array.shape[-1]
        ]
        Sdf.AttributeSpec(prim, name, usd_type).default = vt.FromBuffer(array)
    counts = Sdf.AttributeSpec(prim, "counts", Sdf.ValueTypeNames.IntArray)
    counts.default = Vt.IntArray(len(arrays["LOD0.indices"]) // 3, 3)
    layer.Save()


def write_raw(arrays, file, wait):
    with open(file, "wb") as out:
        for array in arrays.values():
            out.write(array.data)
        out.flush()
        if wait:
            os.fsync(out.fileno())


def best(write, file):
    times = []
    for _ in range(TRIES):
        file.unlink(missing_ok=True)
        start = time.perf_counter()
        write()
        times.append(time.perf_counter() - start)
    return min(times)


if __name__ == "__main__":
    main()

"""Procedural caves, mines and lava tubes for robot simulators.

A recipe and a seed give a cave; a cave gives arrays and packages:

    import plume

    with plume.generate(plume.Recipe({"graph": {"nodes": 30}}, seed=7)) as cave:
        cave.export("isaac", "my-cave-isaac")
        for chunk in cave.chunks:
            print(chunk.name, chunk.positions.shape, chunk.bounds)

Metres, radians, right-handed, Z up. Arrays are NumPy arrays. In the examples of this module `cave` is a cave of 12
stations and `folder` a scratch folder.
"""

from plume._plume import (
    Cave,
    Chunk,
    Chunks,
    Dataset,
    Graph,
    Light,
    Lod,
    Mesh,
    Package,
    Recipe,
    Textures,
    VisualMesh,
    __version__,
    chunk_grid,
    dataset,
    generate,
    generators,
    make_chunks,
    materials,
    open,
    presets,
    register_generator,
    targets,
)
from plume.errors import (
    Fault,
    InputError,
    MissingFileError,
    MissingPartError,
    PlumeError,
    RecipeError,
    StorageError,
)

__all__ = [
    "Cave",
    "Chunk",
    "Chunks",
    "Dataset",
    "Fault",
    "Graph",
    "InputError",
    "Light",
    "Lod",
    "Mesh",
    "MissingFileError",
    "MissingPartError",
    "Package",
    "PlumeError",
    "Recipe",
    "RecipeError",
    "StorageError",
    "Textures",
    "VisualMesh",
    "__version__",
    "chunk_grid",
    "dataset",
    "generate",
    "generators",
    "make_chunks",
    "materials",
    "open",
    "presets",
    "register_generator",
    "targets",
]

"""Whether all packages of one cave are of the same cave."""

import json
from dataclasses import dataclass

import numpy as np
from packages import packages_in, require

PLACE_M = 1e-3
AREA = 1e-3
# Their materials are separate assets next to the meshes, and prefabs or a script put the things in place: their files have the
# walls and the gravel where they are, and the shapes of things once each.
ENGINES = {"unity", "unreal"}


@dataclass
class Figures:
    """The result of a reader for a package."""

    triangles: int
    bounds: np.ndarray
    area_m2: float
    materials: int | None


def verify(folder, readers):
    """Every reader on every package that it reads: they must agree. Gives summary."""
    firsts, summaries = {}, []
    for reader in readers:
        names = []
        for package in packages_in(folder):
            files = reader.files_of(package)
            if files:
                has_shapes = package.name in ENGINES and (package / "instances.json").is_file()
                found = figures(reader, package, [file for file in files if not (has_shapes and is_shape(file))])
                first = firsts.setdefault(has_shapes, found)
                compare(found, first, f"{reader.name} on {package.name}")
                if has_shapes:
                    open_shapes(reader, package, files)
                names.append(package.name)
        summaries += [f"{reader.name} ({', '.join(names)})"] if names else []
    first = firsts.get(False) or firsts.get(True)
    require(first, f"there is nothing in {folder} that {', '.join(reader.name for reader in readers)} could read")
    size = " × ".join(f"{metres:.2f}" for metres in first.bounds[1] - first.bounds[0])
    summary = f"{first.triangles} triangles, {size} m, {first.area_m2:.0f} m²"
    images = f", {first.materials} materials with images" if first.materials else ""
    return f"{summary}{images}: {'; '.join(summaries)}"


def is_shape(file):
    return not file.stem.startswith(("chunk_", "gravel_"))


def open_shapes(reader, package, files):
    """There is a file for the shape of every thing, with triangles."""
    things = json.loads((package / "instances.json").read_text(encoding="utf-8"))["things"]
    shapes = [file for file in files if is_shape(file)]
    for prototype in {thing["prototype"] for thing in things}:
        own = [file for file in shapes if file.stem == prototype or file.stem.startswith(f"{prototype}_level")]
        require(own, f"{reader.name} on {package.name}: there is no file of {prototype}")
        require(
            all(len(reader.read(file).position) for file in own),
            f"{reader.name} on {package.name}: {prototype} is empty",
        )


def figures(reader, package, files):
    triangles, low, high, area_m2, materials = 0, np.full(3, np.inf), np.full(3, -np.inf), 0.0, None
    for path in files:
        corners = reader.read(path).position
        triangles += len(corners)
        low, high = np.minimum(low, corners.min(axis=(0, 1))), np.maximum(high, corners.max(axis=(0, 1)))
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area_m2 += np.linalg.norm(across, axis=1).sum() / 2
        seen = reader.look(path) if reader.look and package.name not in ENGINES else None
        materials = materials if seen is None else (materials or 0) + seen
    return Figures(triangles, np.array([low, high]), area_m2, materials)


def compare(found, first, where):
    require(found.triangles == first.triangles, f"{where}: {found.triangles} triangles instead of {first.triangles}")
    apart = np.abs(found.bounds - first.bounds).max()
    require(apart <= PLACE_M, f"{where}: its bounds are {found.bounds.tolist()}, not {first.bounds.tolist()}")
    off = abs(found.area_m2 / first.area_m2 - 1)
    require(off <= AREA, f"{where}: {found.area_m2} m² instead of {first.area_m2} m²")
    if None in (found.materials, first.materials):
        return
    require(found.materials == first.materials, f"{where}: {found.materials} materials, not {first.materials}")

"""The arrays of the module `plume`, against readers that are not ours: usd-core, plyfile, Pillow."""

from pathlib import Path
from typing import Any

import numpy as np
import plume
import pytest
from PIL import Image
from plyfile import PlyData  # type: ignore[import-untyped]


def read(path: Path) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Vertices and triangles of a PLY."""
    mesh = PlyData.read(str(path))
    return mesh["vertex"].data, np.stack(mesh["face"]["vertex_indices"])


def columns(vertices: np.ndarray[Any, Any], names: str) -> np.ndarray[Any, Any]:
    return np.stack([vertices[name] for name in names.split()], axis=1)


def test_arrays_have_their_shape_and_type(cave: plume.Cave) -> None:
    for chunk in cave.chunks:
        count = len(chunk.positions)
        for array, width in [(chunk.positions, 3), (chunk.normals, 3), (chunk.uvs, 2), (chunk.tangents, 4)]:
            assert array.shape == (count, width) and array.dtype == np.float32 and np.isfinite(array).all()
        for mesh in [chunk, chunk.collision, *chunk.lods]:
            assert mesh.indices.shape[1] == 3 and mesh.indices.dtype == np.uint32 and len(mesh.indices) > 0
            assert mesh.indices.max() < len(mesh.positions)
            box = np.stack([mesh.positions.min(axis=0), mesh.positions.max(axis=0)])
            assert np.array_equal(mesh.bounds, box) and mesh.bounds.dtype == np.float32
        assert np.allclose(np.linalg.norm(chunk.normals, axis=1), 1, atol=1e-3)


def test_levels_of_detail_get_coarser(cave: plume.Cave) -> None:
    for chunk in cave.chunks:
        sizes = [len(mesh.indices) for mesh in [chunk, *chunk.lods]]
        errors_m = [0.0, *(lod.error_m for lod in chunk.lods)]
        assert sizes == sorted(set(sizes), reverse=True) and errors_m == sorted(set(errors_m))
        for lod in chunk.lods:
            assert [len(array) for array in [lod.normals, lod.uvs, lod.tangents]] == [len(lod.positions)] * 3
    assert any(chunk.lods for chunk in cave.chunks)


def test_arrays_are_what_the_files_hold(cave: plume.Cave) -> None:
    for chunk in cave.chunks:
        vertices, triangles = read(cave.folder / "textures" / f"{chunk.name}.ply")
        assert np.array_equal(chunk.positions, columns(vertices, "x y z"))
        assert np.array_equal(chunk.normals, columns(vertices, "nx ny nz"))
        assert np.array_equal(chunk.uvs, columns(vertices, "s t"))
        assert np.array_equal(chunk.tangents, columns(vertices, "tx ty tz tw"))
        assert np.array_equal(chunk.indices, triangles)
        vertices, triangles = read(cave.folder / "collision" / f"{chunk.name}.ply")
        assert np.array_equal(chunk.collision.positions, columns(vertices, "x y z"))
        assert np.array_equal(chunk.collision.indices, triangles)


def test_triangles_face_the_air(cave: plume.Cave) -> None:
    volume_m3 = 0.0
    for chunk in cave.chunks:
        corners = chunk.positions[chunk.indices].astype(np.float64)
        faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        towards = np.einsum("ij,ij->i", faces, chunk.normals[chunk.indices].mean(axis=1))
        assert (towards > 0).mean() > 0.99
        volume_m3 += np.einsum("ij,ij->i", corners[:, 0], faces).sum() / 6
    # The wall is closed, and turned inside out: the air is inside.
    assert volume_m3 < -100


def test_arrays_are_handed_over_without_a_copy(cave: plume.Cave) -> None:
    chunk = cave.chunks[0]
    assert chunk.positions is chunk.positions
    assert chunk.positions.base is not None and chunk.positions.flags.c_contiguous and chunk.positions.flags.writeable


@pytest.mark.parametrize("form", ["png", "jpg", "webp"])
def test_textures_are_what_another_reader_sees(form: str, cave: plume.Cave) -> None:
    with plume.generate(cave.recipe.replace({"texture.format": form})) as cave:
        chunk = cave.chunks[0]
        for name, shape in [
            ("base_color", (256, 256, 3)),
            ("normal", (256, 256, 3)),
            ("orm", (256, 256, 3)),
            ("roughness", (256, 256, 1)),
        ]:
            ours = getattr(chunk.textures, name)
            with Image.open(cave.folder / "textures" / f"{chunk.name}_{name}.{form}") as image:
                theirs = np.asarray(image.convert("L" if shape[2] == 1 else "RGB")).reshape(shape)
            # Decoders of JPEG may round differently by a few levels; PNG and WebP leave no choice.
            difference = np.abs(ours.astype(int) - theirs.astype(int)).max()
            assert ours.shape == shape and ours.dtype == np.uint8 and difference <= (8 if form == "jpg" else 0)
        if form == "webp":
            with pytest.raises(plume.InputError, match="target `gazebo` does not take texture.format"):
                cave.export("gazebo", cave.folder / "package")


def test_heights_are_what_another_reader_sees(cave: plume.Cave) -> None:
    assert cave.chunks[0].textures.height_m is None
    with plume.generate(cave.recipe.replace({"texture.height": True})) as cave:
        chunk = cave.chunks[0]
        with Image.open(cave.folder / "textures" / f"{chunk.name}_height.png") as image:
            assert image.mode == "I;16"
            theirs = np.asarray(image) / 65535 * 0.5 - 0.25
        ours = chunk.textures.height_m
        assert ours is not None and ours.shape == (256, 256) and ours.dtype == np.float32
        assert np.abs(ours - theirs).max() < 1e-6 and 0.005 < ours.std() < 0.2


def test_the_graph_is_that_of_the_folder(cave: plume.Cave) -> None:
    graph = cave.graph
    assert graph.to_json() == (cave.folder / "graph.json").read_text()
    nodes = graph.to_dict()["nodes"]
    assert np.array_equal(graph.positions, [[node["coordinates"][axis] for axis in "xyz"] for node in nodes])
    assert np.array_equal(graph.radii, [node["radius"] for node in nodes])
    ids = [node["id"] for node in nodes]
    edges = {(i, ids.index(end)) for i, node in enumerate(nodes) for end in node["edges"] if i < ids.index(end)}
    assert graph.edges.dtype == np.uint32 and set(map(tuple, graph.edges.tolist())) == edges


def test_spawns_are_poses_in_the_air_over_the_floor(cave: plume.Cave) -> None:
    spawns = cave.spawns
    assert spawns.shape == (8, 4, 4) and spawns.dtype == np.float64
    turns = spawns[:, :3, :3]
    assert np.allclose(turns @ turns.transpose(0, 2, 1), np.eye(3)) and np.allclose(np.linalg.det(turns), 1)
    assert np.allclose(turns[:, :, 2], [0, 0, 1])
    stations = cave.graph.positions
    for pose in spawns:
        over = np.linalg.norm(stations[:, :2] - pose[:2, 3], axis=1).argmin()
        assert np.allclose(stations[over, :2], pose[:2, 3]) and pose[2, 3] < stations[over, 2] + 1
        ends = cave.graph.edges[(cave.graph.edges == over).any(axis=1)]
        ways = [stations[b if a == over else a, :2] - stations[over, :2] for a, b in ends]
        assert any(np.dot(way / np.linalg.norm(way), pose[:2, 0]) > 0.999 for way in ways)


def test_the_field_is_zero_on_the_wall_and_changes_sign_there(cave: plume.Cave) -> None:
    for chunk in cave.chunks:
        corners = chunk.positions[chunk.indices].astype(np.float64)
        middles = corners.mean(axis=1)
        faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        into_air = faces / np.linalg.norm(faces, axis=1, keepdims=True)
        # The mesh omits detail smaller than a voxel.
        assert np.abs(cave.field(middles)).mean() < 0.05
        # Further than the mesh is from the field, and less than the width of a slot in the roof.
        step_m = 0.15
        assert (cave.field(middles + step_m * into_air) < 0).mean() > 0.95
        assert (cave.field(middles - step_m * into_air) > 0).mean() > 0.95


def test_the_field_does_not_depend_on_who_else_is_asked(cave: plume.Cave) -> None:
    low, high = np.min([c.bounds[0] for c in cave.chunks], axis=0), np.max([c.bounds[1] for c in cave.chunks], axis=0)
    points = np.random.default_rng(0).uniform(low, high, (500, 3)).astype(np.float32)
    together = cave.field(points)
    assert together.shape == (500,) and together.dtype == np.float32
    assert np.array_equal(together, np.concatenate([cave.field([point]) for point in points]))
    assert np.array_equal(together[::-2], cave.field(np.asfortranarray(points)[::-2]))
    assert (cave.field([[1e30, 0, 0], [0, 0, -1e6]]) > 0).all()


def test_the_distance_is_that_to_the_triangles(cave: plume.Cave, tmp_path: Path) -> None:
    import plyfile  # type: ignore[import-untyped]
    import trimesh
    import trimesh.proximity

    [path] = cave.export("ply", tmp_path / "ply").path.glob("*.ply")
    data = plyfile.PlyData.read(path)
    labels = {int(label): name for label, name in (c.split()[1:3] for c in data.comments if c.startswith("label "))}
    face = data["face"].data
    solid = np.array([labels[label] != "gravel" for label in face["label"]])
    vertices = np.stack([data["vertex"][axis] for axis in "xyz"], axis=1)
    mesh = trimesh.Trimesh(vertices, np.stack(face["vertex_indices"][solid]), process=False)
    points = np.random.default_rng(1).uniform(mesh.bounds[0] - 1, mesh.bounds[1] + 1, (400, 3)).astype(np.float32)
    _, expected, _ = trimesh.proximity.closest_point(mesh, points)
    found = cave.distance(points)
    assert np.abs(np.abs(found) - expected).max() < 1e-4
    # Where no thing is near, the field knows what is air.
    field = cave.field(points)
    clear = np.abs(field) > 0.3
    assert clear.sum() > 100 and (np.sign(found) == np.sign(field))[clear].mean() > 0.98
    assert np.abs(cave.distance(mesh.triangles_center[::97].astype(np.float32))).max() < 1e-4
    assert (cave.distance([[1e6, 0, 0], [0, 0, -1e6]]) > 1e5).all()


def test_certificates_and_routes(cave: plume.Cave) -> None:
    certificate = cave.certify("leo")
    assert len(certificate["stations"]) == len(cave.graph.positions)
    assert len(certificate["passages"]) == len(cave.graph.edges)
    sure = [station["id"] for station in certificate["stations"] if station["there"] == station["back"] == "go"]
    assert len(sure) > len(certificate["stations"]) / 2
    route = cave.route("longest", robot="leo", height=0.4)
    assert route.shape[1] == 8 and np.allclose(np.linalg.norm(route[:, 4:], axis=1), 1)
    length_m = np.linalg.norm(np.diff(route[:, 1:4], axis=0), axis=1).sum()
    assert np.isclose(length_m, certificate["route"]["length_m"], rtol=0.05)
    # A robot is in the open, and no nearer to the rock than half its width.
    assert cave.distance(route[:, 1:4]).max() < -0.2
    assert cave.route("tour", robot="leo", speed=1.0)[-1, 0] > route[-1, 0] / 2
    with pytest.raises(plume.errors.InputError, match="there is no robot"):
        cave.certify("dalek")
    with pytest.raises(plume.errors.InputError, match="there is no station 1000000"):
        cave.route("1000000..0")


@pytest.mark.parametrize("points", [[1, 2, 3], [[1, 2]], 4, [[0, 0, np.nan]], [[0, np.inf, 0]]])
def test_what_is_no_point_is_refused(points: Any, cave: plume.Cave) -> None:
    with pytest.raises(plume.errors.InputError, match="`points` has"):
        cave.distance(points)


def test_spawns_and_lights_are_those_of_the_stage(cave: plume.Cave, tmp_path: Path) -> None:
    from pxr import Usd, UsdGeom, UsdLux  # type: ignore[import-untyped]

    cave.export("usd", tmp_path / "usd")
    stage = Usd.Stage.Open(str(tmp_path / "usd" / "cave.usda"))
    place = UsdGeom.XformCache()
    prims = {prim.GetName(): np.array(place.GetLocalToWorldTransform(prim)).T for prim in stage.Traverse()}
    lamps = [prim for prim in stage.Traverse() if prim.IsA(UsdLux.SphereLight)]
    assert len(cave.lights) == len(lamps) > 0
    for light in cave.lights:
        assert np.allclose(prims[light.name][:3, 3], light.position, atol=1e-5)
    found = [m for m in prims.values() if np.allclose(m, cave.spawns[0], atol=1e-5)]
    assert found, "no prim of the stage stands at the first start pose"


def test_the_sequence_of_chunks_is_one(cave: plume.Cave) -> None:
    chunks = cave.chunks
    names = chunks.names
    assert len(chunks) == len(names) > 2 and [chunk.name for chunk in chunks] == names
    assert chunks[-1].name == names[-1] and [chunk.name for chunk in chunks[::-2]] == names[::-2]
    for outside in [len(chunks), -len(chunks) - 1]:
        with pytest.raises(IndexError):
            chunks[outside]
    walk = iter(chunks)
    assert next(walk).name == names[0] and [chunk.name for chunk in walk] == names[1:]

"""The stage holds the cave bit for bit: against the PLY files of the cave folder, read by `plyfile`."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from plyfile import PlyData
from pxr import Usd, UsdGeom, UsdPhysics, UsdShade

sys.path.append(str(Path(__file__).parents[1] / "interop/usd"))

import validate  # noqa: E402 - next to the check

ZONES = ["floor", "wall", "ceiling"]


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A package and the cave folder it was made of."""
    folder = tmp_path_factory.mktemp("kept")
    arguments = ["export", "--target", "isaac", "--output", str(folder / "isaac"), "--keep", str(folder / "cave")]
    small = ["--set", "graph.nodes=12", "--set", "texture.size_px=256"]
    subprocess.run([sys.executable, "-m", "plume", *arguments, *small], check=True)
    return folder


def columns(ply, names):
    return np.stack([ply["vertex"][name] for name in names.split()], axis=1)


def indices(ply):
    return np.concatenate(ply["face"]["vertex_indices"])


def same_bits(attribute, expected, dtype):
    found = np.asarray(attribute.Get())
    assert found.dtype == dtype and found.shape == expected.shape
    assert found.tobytes() == expected.astype(dtype).tobytes()


def layers(kept):
    """Those of the wall: what the cave folder has as it is."""
    found = sorted((kept / "isaac/chunks").glob("chunk_*.usdc"))
    assert len(found) > 1
    return found


def test_visual_arrays_are_those_of_the_cave(kept):
    for layer in layers(kept):
        stage = Usd.Stage.Open(str(layer))
        levels = stage.GetPrimAtPath("/Chunk").GetVariantSet("LOD")
        for level in levels.GetVariantNames():
            levels.SetVariantSelection(level)
            suffix = "" if level == "LOD0" else f"_{level.lower()}"
            ply = PlyData.read(str(kept / f"cave/textures/{layer.stem}{suffix}.ply"))
            mesh = UsdGeom.Mesh.Get(stage, "/Chunk/Visual")
            same_bits(mesh.GetPointsAttr(), columns(ply, "x y z"), np.float32)
            same_bits(mesh.GetNormalsAttr(), columns(ply, "nx ny nz"), np.float32)
            same_bits(mesh.GetPrim().GetAttribute("primvars:st"), columns(ply, "s t"), np.float32)
            same_bits(mesh.GetFaceVertexIndicesAttr(), indices(ply), np.int32)
            assert set(mesh.GetFaceVertexCountsAttr().Get()) == {3}


def test_collision_arrays_are_those_of_the_cave(kept):
    for layer in layers(kept):
        stage = Usd.Stage.Open(str(layer))
        ply = PlyData.read(str(kept / f"cave/collision/{layer.stem}.ply"))
        mesh = UsdGeom.Mesh.Get(stage, "/Chunk/Collision")
        points, corners = np.asarray(mesh.GetPointsAttr().Get()), np.asarray(mesh.GetFaceVertexIndicesAttr().Get())
        expected = columns(ply, "x y z")
        # Vertices in which two parts of a chunk touch have copies at the end.
        assert points[: len(expected)].tobytes() == expected.tobytes()
        assert points[corners].tobytes() == expected[indices(ply)].tobytes()


@pytest.fixture(scope="module")
def merged(kept, tmp_path_factory):
    """The package of the same cave with one collision mesh."""
    folder = tmp_path_factory.mktemp("merged") / "isaac"
    arguments = ["export", str(kept / "cave"), "--target", "isaac", "--output", str(folder), "--quiet"]
    subprocess.run([sys.executable, "-m", "plume", *arguments, "--option", "isaac.collision=merged"], check=True)
    return folder


def test_the_merged_collider_is_the_first_mesh_and_has_all_triangles(kept, merged):
    chunks = json.loads((kept / "isaac/manifest.json").read_text(encoding="utf-8"))["chunks"]
    stage = Usd.Stage.Open(str(merged / "cave.usda"))
    first = next(prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh))
    assert first.GetPath() == "/World/Collision"
    mesh = UsdGeom.Mesh(first)
    assert len(mesh.GetFaceVertexCountsAttr().Get()) == sum(chunk["collision_triangles"] for chunk in chunks)
    assert UsdGeom.Imageable(first).ComputePurpose() == UsdGeom.Tokens.guide
    ground, _ = UsdShade.MaterialBindingAPI(first).ComputeBoundMaterial("physics")
    assert ground.GetPath() == "/World/Materials/Ground"
    every = Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies())
    assert [prim.GetPath() for prim in every if prim.HasAPI(UsdPhysics.CollisionAPI)] == [first.GetPath()]


def test_the_merged_collider_is_where_those_of_the_chunks_are(kept, merged):
    points, corners = arrays(merged / "cave.usda", "/World/Collision")
    whole = {triangle.tobytes() for triangle in points[corners]}
    for layer in layers(kept):
        points, corners = arrays(layer, "/Chunk/Collision")
        assert whole.issuperset(triangle.tobytes() for triangle in points[corners])


def arrays(layer, path):
    """Points, and the corners of triangles, of a mesh."""
    stage = Usd.Stage.Open(str(layer))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(path))
    return np.asarray(mesh.GetPointsAttr().Get()), np.asarray(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)


def test_the_validators_accept_a_merged_collider(merged):
    validate.verify(merged)


def test_pieces_are_those_of_the_cave(pieces):
    for layer in layers(pieces):
        stage = Usd.Stage.Open(str(layer))
        ply = PlyData.read(str(pieces / f"cave/pieces/{layer.stem}.ply"))
        points, corners, piece_of_face = (
            columns(ply, "x y z"),
            np.stack(ply["face"]["vertex_indices"]),
            ply["face"]["piece"],
        )
        found = [prim for prim in stage.Traverse() if prim.GetName().startswith("piece_")]
        assert len(found) == len(np.unique(piece_of_face))
        for prim in found:
            own = piece_of_face == int(prim.GetName().removeprefix("piece_"))
            mesh = UsdGeom.Mesh(prim)
            triangles = np.asarray(mesh.GetPointsAttr().Get())[np.asarray(mesh.GetFaceVertexIndicesAttr().Get())]
            assert triangles.tobytes() == points[corners[own]].tobytes()
            zone = ZONES[ply["face"]["zone"][own][0]]
            assert prim.GetParent().GetPath() == f"/Chunk/Collision/{zone}"
            ground, _ = UsdShade.MaterialBindingAPI(mesh).ComputeBoundMaterial("physics")
            assert ground.GetPath() == f"/Chunk/Looks/{zone.title()}"


def test_images_are_those_of_the_cave(kept):
    images = sorted((kept / "isaac/chunks/textures").glob("chunk_*"))
    assert len(images) == 3 * len(layers(kept))
    for image in images:
        assert image.read_bytes() == (kept / "cave/textures" / image.name).read_bytes()


def test_every_option_is_in_the_stage(tmp_path):
    options = ["--option", "usd.physics=false", "--option", "usd.lights=false", "--quiet"]
    small = ["--set", "graph.nodes=12", "--set", "texture.size_px=256"]
    command = [sys.executable, "-m", "plume", "export", "--target", "usd", "--output", str(tmp_path / "usd")]
    subprocess.run([*command, *options, *small], check=True)
    stage = Usd.Stage.Open(str(tmp_path / "usd/cave.usda"))
    names = {prim.GetName() for prim in stage.TraverseAll()}
    assert not names & {"Collision", "PhysicsScene", "Ground", "Lights"}
    assert "Visual" in names

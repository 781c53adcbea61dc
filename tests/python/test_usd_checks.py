"""The checks of USD packages: a good one passes, and each fault is noticed."""

import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdPhysics, UsdShade, Vt

sys.path.append(str(Path(__file__).parents[1] / "interop/usd"))

import laws  # noqa: E402 - next to the check
import validate  # noqa: E402 - next to it


def said_of(package):
    """What the check finds wrong with a package; nothing with a good one. In this process, since each new one loads the
    validators for two seconds."""
    try:
        validate.verify(package)
    except (validate.Failure, Tf.ErrorException) as failure:
        return str(failure)
    return ""


@pytest.mark.parametrize("target", ["isaac", "usd", "usdz"])
def test_a_good_package_passes(target, packages):
    assert said_of(packages / target) == ""


def test_a_good_package_of_pieces_passes(pieces):
    assert said_of(pieces / "isaac") == ""


def root(package):
    return Sdf.Layer.FindOrOpen(str(package / "cave.usda"))


def chunk(package):
    return Sdf.Layer.FindOrOpen(str(sorted((package / "chunks").glob("*.usdc"))[0]))


def edit(layer, change):
    stage = Usd.Stage.Open(layer, Usd.Stage.LoadNone)
    change(stage)
    assert layer.dirty, "the change changed nothing"
    layer.Save()


def clear_metadata(key):
    return lambda package: edit(root(package), lambda stage: stage.ClearMetadata(key))


def in_chunk(change):
    return lambda package: edit(chunk(package), change)


def in_level(change):
    """A change of the visual mesh inside its finest level of detail."""

    def edited(stage):
        levels = stage.GetPrimAtPath("/Chunk").GetVariantSet("LOD")
        levels.SetVariantSelection("LOD0")
        with levels.GetVariantEditContext():
            change(UsdGeom.Mesh.Get(stage, "/Chunk/Visual"))

    return in_chunk(edited)


def array(name, change):
    """Changes a copy of an array of the visual mesh."""

    def edited(mesh):
        attribute = mesh.GetPrim().GetAttribute(name)
        kind = type(attribute.Get())
        attribute.Set(kind.FromNumpy(np.ascontiguousarray(change(np.array(attribute.Get())))))

    return in_level(edited)


def flip_face(indices):
    indices[:2] = indices[1::-1]
    return indices


def flip_all(indices):
    return indices.reshape(-1, 3)[:, ::-1].ravel()


def out_of_range(indices):
    indices[5] = 10_000_000
    return indices


def clear(attribute):
    return in_level(lambda mesh: mesh.GetPrim().GetAttribute(attribute).Block())


def shader_input(shader, name, value):
    def change(stage):
        UsdShade.Shader.Get(stage, f"/Chunk/Looks/Rock/{shader}").GetInput(name).Set(value)

    return in_chunk(change)


def on_collision(change):
    return in_chunk(lambda stage: change(stage.GetPrimAtPath("/Chunk/Collision")))


def make_rigid(stage):
    UsdPhysics.RigidBodyAPI.Apply(stage.GetPrimAtPath("/Chunk"))
    UsdPhysics.RigidBodyAPI.Apply(stage.GetPrimAtPath("/Chunk/Collision"))


def unbind_friction(package):
    def change(stage):
        UsdShade.MaterialBindingAPI(stage.GetPrimAtPath("/World/Chunks")).UnbindDirectBinding("physics")

    edit(root(package), change)


def absolute_payload(package):
    layer = sorted((package / "chunks").glob("*.usdc"))[0]

    def change(stage):
        prim = stage.GetPrimAtPath(f"/World/Chunks/{layer.stem}")
        prim.GetPayloads().SetPayloads([Sdf.Payload(str(layer.resolve()))])

    edit(root(package), change)


def remove(pattern):
    return lambda package: sorted(package.glob(pattern))[0].unlink()


def forget_recipe(package):
    edit(root(package), lambda stage: stage.GetPrimAtPath("/World").ClearCustomDataByKey("plume"))


def tear_chunk(package):
    file = sorted((package / "chunks").glob("*.usdc"))[0]
    file.write_bytes(file.read_bytes()[:1000])


def point_gravity_up(package):
    edit(
        root(package),
        lambda stage: UsdPhysics.Scene.Get(stage, "/PhysicsScene").GetGravityDirectionAttr().Set(Gf.Vec3f(0, 0, 1)),
    )


def misstate_size(package):
    def change(stage):
        prim = stage.GetPrimAtPath("/World/Chunks").GetAllChildren()[0]
        UsdGeom.ModelAPI(prim).SetExtentsHint(Vt.Vec3fArray([(0, 0, 0), (1, 1, 1)]))

    edit(root(package), change)


def repeat_level(stage):
    levels = stage.GetPrimAtPath("/Chunk").GetVariantSet("LOD")
    finest = Sdf.Path("/Chunk").AppendVariantSelection("LOD", "LOD0")
    levels.AddVariant("LOD1")
    layer = stage.GetRootLayer()
    Sdf.CopySpec(layer, finest, layer, Sdf.Path("/Chunk").AppendVariantSelection("LOD", "LOD1"))


def lose_arrays(mesh):
    for name in ["points", "normals", "faceVertexCounts", "faceVertexIndices", "primvars:st"]:
        mesh.GetPrim().GetAttribute(name).Block()


def double_point(mesh):
    """One of the faces round a point gets a copy of it for itself."""
    corners = np.array(mesh.GetFaceVertexIndicesAttr().Get())
    at = np.flatnonzero(corners == np.bincount(corners).argmax())[0]
    for name in ["points", "normals", "primvars:st"]:
        attribute = mesh.GetPrim().GetAttribute(name)
        values = np.array(attribute.Get())
        attribute.Set(type(attribute.Get()).FromNumpy(np.concatenate([values, values[corners[at]][None]])))
    corners[at] = len(values)
    mesh.GetFaceVertexIndicesAttr().Set(Vt.IntArray.FromNumpy(corners))


def take_roughness_from_red(stage):
    surface = UsdShade.Shader.Get(stage, "/Chunk/Looks/Rock/Surface").GetInput("roughness")
    source = surface.GetConnectedSources()[0][0].source
    surface.ConnectToSource(source, "r")


def stop_colliding(prim):
    UsdPhysics.CollisionAPI(prim).CreateCollisionEnabledAttr(False)


def move_view(change):
    return lambda package: edit(
        root(package), lambda stage: change(UsdGeom.Xformable(stage.GetPrimAtPath("/World/View")))
    )


FAULTS = {
    "a level without arrays": (in_level(lose_arrays), "has levels of [0"),
    "a level missing from the middle": (
        in_chunk(lambda stage: stage.GetPrimAtPath("/Chunk").GetVariantSet("LOD").AddVariant("LOD9")),
        "levels_get_coarser",
    ),
    "a point twice": (in_level(double_point), "twins_stand_only_at_pinches"),
    "flat texture coordinates": (array("primvars:st", np.zeros_like), "st_covers_the_image"),
    "a base colour as data": (shader_input("BaseColor", "sourceColorSpace", "raw"), "rock_has_maps"),
    "roughness from the wrong channel": (in_chunk(take_roughness_from_red), "rock_has_maps"),
    "a collider that is off": (on_collision(stop_colliding), "does not collide"),
    "a view from far away": (
        move_view(lambda view: view.AddTranslateOp(opSuffix="away").Set(Gf.Vec3d(0, 0, 50))),
        "is not over",
    ),
    "a view on its side": (move_view(lambda view: view.AddRotateZOp(opSuffix="roll").Set(90.0)), "is tilted"),
    "a wrong size": (misstate_size, "has another size when it is open"),
    "a level no coarser": (in_chunk(repeat_level), "levels_get_coarser"),
    "no metres": (clear_metadata("metersPerUnit"), "metersPerUnit"),
    "no default prim": (clear_metadata("defaultPrim"), "defaultPrim"),
    "Y up": (lambda package: edit(root(package), lambda stage: UsdGeom.SetStageUpAxis(stage, "Y")), "units_are_metres"),
    "a missing texture": (remove("chunks/textures/*_normal.png"), "images_are_written_as_relative_paths"),
    "a texture elsewhere": (
        shader_input("BaseColor", "file", Sdf.AssetPath("/elsewhere/base.png")),
        "elsewhere/base.png",
    ),
    "a coloured normal map": (shader_input("Normal", "sourceColorSpace", "sRGB"), "NormalMapTexture"),
    "an unscaled normal map": (shader_input("Normal", "scale", Gf.Vec4f(1, 1, 1, 1)), "NormalMapTexture"),
    "an index out of range": (array("faceVertexIndices", out_of_range), "ValidateTopologyChecker"),
    "a wrong extent": (array("extent", lambda extent: extent * 2), "ExtentsChecker"),
    "a flipped face": (array("faceVertexIndices", flip_face), "ManifoldChecker"),
    "a mesh inside out": (array("faceVertexIndices", flip_all), "normals_are_on_the_side"),
    "no normals": (clear("normals"), "NormalsExistChecker"),
    "no st": (clear("primvars:st"), "visual_meshes_have_every_array"),
    "half of the st": (array("primvars:st", lambda st: st[::2]), "visual_meshes_have_every_array"),
    "a subdivided mesh": (
        in_chunk(lambda stage: UsdGeom.Mesh.Get(stage, "/Chunk/Visual").GetSubdivisionSchemeAttr().Set("catmullClark")),
        "is subdivided",
    ),
    "nested rigid bodies": (in_chunk(make_rigid), "is a rigid body"),
    "a dynamic collision mesh": (on_collision(UsdPhysics.RigidBodyAPI.Apply), "is a rigid body"),
    "a convex hull": (
        on_collision(lambda prim: UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr().Set("convexHull")),
        "is approximated by convexHull",
    ),
    "a drawn collision mesh": (
        on_collision(lambda prim: UsdGeom.Imageable(prim).GetPurposeAttr().Set("default")),
        "is drawn",
    ),
    "no friction": (unbind_friction, "has no physics material"),
    "gravity upwards": (point_gravity_up, "gravity does not point down"),
    "an absolute payload": (absolute_payload, "is absolute or climbs out"),
    "a missing chunk": (remove("chunks/*.usdc"), "does not exist"),
    "a file too many": (lambda package: (package / "chunks/old.png").write_text("old"), "is used by nothing"),
    "a label that is none": (
        in_level(
            lambda mesh: (
                UsdGeom.Subset(mesh.GetPrim().GetChild("floor")).GetIndicesAttr().Set(Vt.IntArray([0, 1, 10**7]))
            )
        ),
        "InvalidSubsetFamily",
    ),
    "a torn chunk": (tear_chunk, "corrupt"),
    "no recipe": (forget_recipe, "customData has no recipe"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_faulty_package_fails(fault, packages, tmp_path):
    change, message = FAULTS[fault]
    package = tmp_path / "package"
    shutil.copytree(packages / "isaac", package)
    change(package)
    said = said_of(package)
    assert message in said, said


def on_piece(change):
    """A change of the first piece of the wall."""
    return in_chunk(lambda stage: change(stage.GetPrimAtPath("/Chunk/Collision/wall").GetAllChildren()[0]))


def dent(prim):
    """Pulls a corner to the other side of the piece."""
    points = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get())
    points[0] = 2 * points.mean(axis=0) - points[0]
    UsdGeom.Mesh(prim).GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(points))
    UsdGeom.Mesh(prim).GetExtentAttr().Set(Vt.Vec3fArray.FromNumpy(np.array([points.min(0), points.max(0)])))


# Those that only our laws notice: the validators take long over many meshes.
PIECE_FAULTS = {
    "a piece with a dent": (on_piece(dent), "is not convex"),
    "a piece that keeps its triangles": (
        on_piece(lambda prim: UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr().Set("none")),
        "is approximated by none",
    ),
    "a piece that is off": (on_piece(stop_colliding), "does not collide"),
    "a drawn piece": (on_piece(lambda prim: UsdGeom.Imageable(prim).GetPurposeAttr().Set("default")), "is drawn"),
    "a chunk without pieces": (in_chunk(lambda stage: stage.RemovePrim("/Chunk/Collision")), "chunks collide"),
}


@pytest.mark.parametrize("fault", PIECE_FAULTS)
def test_a_faulty_package_of_pieces_fails(fault, pieces, tmp_path):
    change, message = PIECE_FAULTS[fault]
    package = tmp_path / "package"
    shutil.copytree(pieces / "isaac", package)
    change(package)
    said = laws.broken(Usd.Stage.Open(str(package / "cave.usda")))
    assert any(message in line for line in said), said

"""Authors the layers of a USD stage with usd-core. The other half of `stage.rs`, which calls these functions.

What is written where is decided there and arrives as plain JSON in `spec`; large arrays arrive separately as NumPy arrays
and are removed from `arrays` as soon as USD has its copy, so that memory stays at one chunk.
"""

import math
import os
import time
from pathlib import Path

from pxr import Gf, Kind, Sdf, Usd, UsdGeom, UsdLux, UsdPhysics, UsdSemantics, UsdShade, UsdUtils, Vt

LAMP_RADIUS_M = 0.05  # chosen: a bare bulb


def write_chunk(spec, arrays):
    """A layer with one chunk: the visual mesh at every level of detail, its material, the collision mesh."""
    stage = new_stage(spec["path"])
    chunk = UsdGeom.Xform.Define(stage, "/Chunk")
    stage.SetDefaultPrim(chunk.GetPrim())
    Usd.ModelAPI(chunk).SetKind(Kind.Tokens.component)
    label(chunk, ["cave"])
    define_visual(stage, "/Chunk", spec, arrays)
    if spec["zones"]:
        UsdGeom.Scope.Define(stage, "/Chunk/Collision")
    for zone in spec["zones"]:
        define_zone(stage, f"/Chunk/Collision/{zone['name']}", zone)
    for collider in spec["colliders"]:
        define_collider(stage, f"/Chunk/{collider['name']}", collider, arrays)
    save(stage)


def write_prototypes(spec, arrays):
    """A layer with the shapes of things, each with all that it needs, for instances to refer to."""
    stage = new_stage(spec["path"])
    stage.SetDefaultPrim(UsdGeom.Scope.Define(stage, "/Prototypes").GetPrim())
    for prototype in spec["prototypes"]:
        path = f"/Prototypes/{prototype['name']}"
        UsdGeom.Xform.Define(stage, path)
        define_visual(stage, path, prototype, arrays)
        if prototype["collider"]:
            touched = define_body_shape(stage, prototype["name"], path) if spec["apart"] else path
            define_collider(stage, f"{touched}/Collision", prototype["collider"], arrays)
    save(stage)


def define_body_shape(stage, name, path):
    """A prototype once more, to which a collider can be added: what does not move does without."""
    UsdGeom.Scope.Define(stage, "/Bodies")
    body = UsdGeom.Xform.Define(stage, f"/Bodies/{name}")
    body.GetPrim().GetReferences().AddInternalReference(path)
    return body.GetPath()


def write_collision(spec, arrays):
    """A layer with the collider of all that does not move."""
    stage = new_stage(spec["path"])
    define_collider(stage, "/Collision", spec["collider"], arrays)
    stage.SetDefaultPrim(stage.GetPrimAtPath("/Collision"))
    save(stage)


def write_things(spec, arrays):
    """A layer with the things of a chunk: instances of the prototypes, so that many share one mesh and one collider.

    Not a PointInstancer: UsdPhysics does not look into one. A level of the chunk has each thing at its own level.
    """
    stage = new_stage(spec["path"])
    chunk = UsdGeom.Xform.Define(stage, "/Chunk")
    stage.SetDefaultPrim(chunk.GetPrim())
    Usd.ModelAPI(chunk).SetKind(Kind.Tokens.component)
    for zone in spec["zones"]:
        define_zone(stage, f"/Chunk/{zone['name']}", zone)
    for thing in spec["things"]:
        define_thing(stage, thing)
    levels = chunk.GetPrim().GetVariantSets().AddVariantSet("LOD")
    for level in spec["levels"]:
        levels.AddVariant(level)
    levels.SetVariantSelection(spec["levels"][0])
    # Below the stage, which would compose the chunk anew after each selection.
    with Sdf.ChangeBlock():
        for number, level in enumerate(spec["levels"]):
            for thing in spec["things"]:
                at = Sdf.Path(f"/Chunk{{LOD={level}}}{thing['zone']}/{thing['name']}")
                selected = thing["levels"][min(number, len(thing["levels"]) - 1)]
                Sdf.CreatePrimInLayer(stage.GetRootLayer(), at).variantSelections["LOD"] = selected
    save(stage)


def define_thing(stage, spec):
    thing = UsdGeom.Xform.Define(stage, f"/Chunk/{spec['zone']}/{spec['name']}")
    place(thing, spec)
    thing.AddScaleOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(spec["scale"]))
    prim = thing.GetPrim()
    prim.GetReferences().AddReference(spec["layer"], spec["prototype"])
    prim.SetInstanceable(True)
    label(prim, [spec["class"]])
    if "body" in spec:
        define_body(prim, spec["body"])


def define_body(prim, spec):
    """What moves when it is pushed. All that tells how is written out, for engines would estimate it differently."""
    UsdPhysics.RigidBodyAPI.Apply(prim)
    mass = UsdPhysics.MassAPI.Apply(prim)
    mass.CreateMassAttr(spec["mass_kg"])
    mass.CreateCenterOfMassAttr(Gf.Vec3f(*spec["center"]))
    mass.CreateDiagonalInertiaAttr(Gf.Vec3f(*spec["inertia_kg_m2"]))
    mass.CreatePrincipalAxesAttr(Gf.Quatf(*spec["axes_wxyz"]))


def write_gravel(spec, arrays):
    """A layer with the gravel of a chunk, as one PointInstancer: nothing collides with it. A level hides what is smallest."""
    stage = new_stage(spec["path"])
    chunk = UsdGeom.Xform.Define(stage, "/Chunk")
    stage.SetDefaultPrim(chunk.GetPrim())
    Usd.ModelAPI(chunk).SetKind(Kind.Tokens.component)
    rock = define_rock(stage, "/Chunk/Looks", spec["textures"])
    gravel = UsdGeom.PointInstancer.Define(stage, "/Chunk/Gravel")
    label(gravel, ["gravel"])
    UsdShade.MaterialBindingAPI.Apply(gravel.GetPrim()).Bind(rock)
    for shape in spec["shapes"]:
        mesh = define_mesh(stage, f"/Chunk/Gravel/{shape['name']}")
        fill_visual(mesh, shape, arrays)
        gravel.GetPrototypesRel().AddTarget(mesh.GetPath())
    stones = spec["stones"]
    gravel.CreateProtoIndicesAttr([stone["shape"] for stone in stones])
    gravel.CreatePositionsAttr([Gf.Vec3f(*stone["position"]) for stone in stones])
    gravel.CreateOrientationsAttr([Gf.Quath(*stone["orientation_wxyz"]) for stone in stones])
    gravel.CreateScalesAttr([Gf.Vec3f(stone["scale"]) for stone in stones])
    gravel.CreateExtentAttr(box(spec["extent"]))
    levels = chunk.GetPrim().GetVariantSets().AddVariantSet("LOD")
    for level in spec["levels"]:
        levels.AddVariant(level["name"])
        levels.SetVariantSelection(level["name"])
        with levels.GetVariantEditContext():
            gravel.CreateInvisibleIdsAttr(list(range(level["shown"], len(stones))))
            gravel.GetPrim().SetCustomDataByKey("plume:error_m", level["error_m"])
    levels.SetVariantSelection(spec["levels"][0]["name"])
    save(stage)


def write_root(spec, arrays):
    """The root layer: physics, lights, start poses, and a payload per chunk, none of which is opened."""
    stage = new_stage(spec["path"])
    if "layer_data" in spec:
        stage.GetRootLayer().customLayerData = typed(spec["layer_data"])
    stage.GetRootLayer().documentation = spec["description"]
    world = UsdGeom.Xform.Define(stage, "/World")
    stage.SetDefaultPrim(world.GetPrim())
    describe(world.GetPrim(), spec)
    # Before the chunks: readers that take one mesh take the first.
    touched = [define_merged(stage, spec["collision"])] if "collision" in spec else []
    chunks = UsdGeom.Xform.Define(stage, "/World/Chunks")
    Usd.ModelAPI(chunks).SetKind(Kind.Tokens.group)
    for chunk in spec["chunks"]:
        define_payload(stage, chunk)
    if "physics" in spec:
        define_physics(stage, [*touched, chunks], spec["physics"])
    if spec["lights"]:
        UsdGeom.Scope.Define(stage, "/World/Lights")
    for light in spec["lights"]:
        define_light(stage, light)
    UsdGeom.Scope.Define(stage, "/World/Spawns")
    for number, pose in enumerate(spec["spawns"]):
        place(UsdGeom.Xform.Define(stage, f"/World/Spawns/spawn_{number}"), pose)
    if spec["stations"]:
        UsdGeom.Scope.Define(stage, "/World/Stations")
    for station in spec["stations"]:
        define_station(stage, station)
    define_camera(stage, spec["camera"])
    save(stage)


def write_usdz(spec, arrays):
    """An archive of the stage `root` and everything it refers to."""
    # USD stores the local time of every file, so it is fixed for the same stage to give the same bytes.
    noon = time.mktime((1980, 1, 1, 12, 0, 0, 0, 0, -1))
    for file in Path(spec["root"]).parent.rglob("*"):
        os.utime(file, (noon, noon))
    if not UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(spec["root"]), spec["path"]):
        raise OSError("USD could not make the archive")


def new_stage(path):
    """An empty stage in `path`: metres, kilograms, Z up. Payloads stay closed, because adding one must not compose it."""
    stage = Usd.Stage.CreateNew(path, Usd.Stage.LoadNone)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    return stage


def save(stage):
    stage.GetRootLayer().Save()


def define_visual(stage, root, spec, arrays):
    """The visual mesh below `root` at every level of detail, and its material."""
    rock = define_rock(stage, f"{root}/Looks", spec["textures"])
    visual = define_mesh(stage, f"{root}/Visual")
    UsdShade.MaterialBindingAPI.Apply(visual.GetPrim()).Bind(rock)
    levels = stage.GetPrimAtPath(root).GetVariantSets().AddVariantSet("LOD")
    for level in spec["levels"]:
        levels.AddVariant(level["name"])
        levels.SetVariantSelection(level["name"])
        with levels.GetVariantEditContext():
            fill_visual(visual, level, arrays)
            visual.GetPrim().SetCustomDataByKey("plume:error_m", level["error_m"])
    levels.SetVariantSelection(spec["levels"][0]["name"])


def define_mesh(stage, path):
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    mesh.CreateOrientationAttr(UsdGeom.Tokens.rightHanded)
    mesh.CreateDoubleSidedAttr(False)
    return mesh


def fill_triangles(mesh, spec, arrays, shading):
    key = spec["arrays"]
    indices = Vt.IntArray.FromBuffer(arrays.pop(f"{key}.indices"))
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromBuffer(arrays.pop(f"{key}.points")))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray(len(indices) // 3, 3))
    mesh.CreateFaceVertexIndicesAttr(indices)
    mesh.CreateExtentAttr(box(spec["extent"]))
    mesh.CreateNormalsAttr(Vt.Vec3fArray.FromBuffer(arrays.pop(f"{key}.normals")))
    mesh.SetNormalsInterpolation(shading)


def fill_visual(mesh, spec, arrays):
    fill_triangles(mesh, spec, arrays, UsdGeom.Tokens.vertex)
    key = spec["arrays"]
    st = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.vertex)
    st.Set(Vt.Vec2fArray.FromBuffer(arrays.pop(f"{key}.st")))
    for part in spec["parts"]:
        faces = Vt.IntArray.FromBuffer(arrays.pop(f"{key}.{part}"))
        subset = UsdGeom.Subset.CreateGeomSubset(mesh, part, UsdGeom.Tokens.face, faces, "semantics")
        label(subset, [part])
    if spec["parts"]:
        UsdGeom.Subset.SetFamilyType(mesh, "semantics", UsdGeom.Tokens.partition)


def define_zone(stage, path, spec):
    """A scope with its own friction, if it has one."""
    zone = UsdGeom.Scope.Define(stage, path)
    if spec["friction"] is None:
        return
    UsdGeom.Scope.Define(stage, "/Chunk/Looks")
    ground = define_ground(stage, f"/Chunk/Looks/{spec['name'].title()}", spec["friction"])
    bind_ground(zone, ground)


def define_collider(stage, path, spec, arrays):
    """A collider: never rendered, and static unless the thing that it belongs to is a rigid body."""
    mesh = define_mesh(stage, path)
    fill_triangles(mesh, spec, arrays, UsdGeom.Tokens.uniform)
    mesh.CreatePurposeAttr(UsdGeom.Tokens.guide)
    UsdPhysics.CollisionAPI.Apply(mesh.GetPrim())
    UsdPhysics.MeshCollisionAPI.Apply(mesh.GetPrim()).CreateApproximationAttr(spec["approximation"])


def define_rock(stage, looks, textures):
    UsdGeom.Scope.Define(stage, looks)
    rock = UsdShade.Material.Define(stage, f"{looks}/Rock")
    surface = shader(rock, "Surface", "UsdPreviewSurface")
    reader = shader(rock, "Reader", "UsdPrimvarReader_float2")
    reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("st")
    st = reader.CreateOutput("result", Sdf.ValueTypeNames.Float2)
    types = Sdf.ValueTypeNames
    color = texture(rock, "BaseColor", textures["base_color"], "sRGB", st)
    connect(surface, "diffuseColor", types.Color3f, color, "rgb", types.Float3)
    bumps = texture(rock, "Normal", textures["normal"], "raw", st)
    bumps.CreateInput("scale", types.Float4).Set(Gf.Vec4f(2, 2, 2, 1))
    bumps.CreateInput("bias", types.Float4).Set(Gf.Vec4f(-1, -1, -1, 0))
    connect(surface, "normal", types.Normal3f, bumps, "rgb", types.Float3)
    orm = texture(rock, "OcclusionRoughness", textures["orm"], "raw", st)
    connect(surface, "occlusion", types.Float, orm, "r", types.Float)
    connect(surface, "roughness", types.Float, orm, "g", types.Float)
    surface.CreateInput("metallic", types.Float).Set(0.0)
    rock.CreateSurfaceOutput().ConnectToSource(surface.CreateOutput("surface", types.Token))
    return rock


def shader(material, name, identifier):
    made = UsdShade.Shader.Define(material.GetPrim().GetStage(), material.GetPath().AppendChild(name))
    made.CreateIdAttr(identifier)
    return made


def texture(material, name, file, color_space, st):
    made = shader(material, name, "UsdUVTexture")
    types = Sdf.ValueTypeNames
    made.CreateInput("file", types.Asset).Set(Sdf.AssetPath(file))
    made.CreateInput("sourceColorSpace", types.Token).Set(color_space)
    made.CreateInput("st", types.Float2).ConnectToSource(st)
    for side in ["wrapS", "wrapT"]:
        made.CreateInput(side, types.Token).Set("repeat")
    return made


def connect(surface, name, input_type, source, channel, output_type):
    surface.CreateInput(name, input_type).ConnectToSource(source.CreateOutput(channel, output_type))


def describe(world, spec):
    model = Usd.ModelAPI(world)
    model.SetKind(Kind.Tokens.assembly)
    model.SetAssetName(spec["name"])
    model.SetAssetIdentifier(Sdf.AssetPath(f"./{spec['name']}.usda"))
    model.SetAssetVersion(spec["generator"])
    world.SetCustomDataByKey("plume", {"generator": spec["generator"], "recipe": spec["recipe"]})
    label(world, ["cave"])


def define_payload(stage, spec):
    prim = UsdGeom.Xform.Define(stage, f"/World/Chunks/{spec['name']}").GetPrim()
    Usd.ModelAPI(prim).SetKind(Kind.Tokens.component)
    prim.GetPayloads().AddPayload(spec["layer"])
    # Gives a chunk an extent while it is not loaded.
    UsdGeom.ModelAPI.Apply(prim).SetExtentsHint(box(spec["extent"]))


def define_merged(stage, spec):
    """The collider of all that does not move. It is a mesh even while its layer is not loaded."""
    mesh = UsdGeom.Mesh.Define(stage, "/World/Collision")
    mesh.GetPrim().GetPayloads().AddPayload(spec["layer"])
    return mesh


def define_physics(stage, touched, spec):
    # Outside the world: a stage that references the cave has its own physics scene.
    scene = UsdPhysics.Scene.Define(stage, "/PhysicsScene")
    scene.CreateGravityDirectionAttr(Gf.Vec3f(0, 0, -1))
    scene.CreateGravityMagnitudeAttr(spec["gravity_m_s2"])
    if "friction" in spec:
        UsdGeom.Scope.Define(stage, "/World/Materials")
        ground = define_ground(stage, "/World/Materials/Ground", spec["friction"])
        for prim in touched:
            bind_ground(prim, ground)


def define_ground(stage, path, friction):
    ground = UsdShade.Material.Define(stage, path)
    material = UsdPhysics.MaterialAPI.Apply(ground.GetPrim())
    material.CreateStaticFrictionAttr(friction)
    material.CreateDynamicFrictionAttr(friction)
    material.CreateRestitutionAttr(0.0)
    return ground


def bind_ground(prim, ground):
    binding = UsdShade.MaterialBindingAPI.Apply(prim.GetPrim())
    binding.Bind(ground, UsdShade.Tokens.fallbackStrength, "physics")


def define_station(stage, spec):
    """An empty Xform, whose display name is what the survey calls the station."""
    station = UsdGeom.Xform.Define(stage, f"/World/Stations/{spec['frame']}")
    station.AddTranslateOp().Set(Gf.Vec3d(*spec["position"]))
    station.GetPrim().SetMetadata("displayName", spec["name"])


def define_light(stage, spec):
    """A small bright sphere: its luminance in nits is the luminous intensity divided by the projected area."""
    light = UsdLux.SphereLight.Define(stage, f"/World/Lights/{spec['name']}")
    light.CreateRadiusAttr(LAMP_RADIUS_M)
    light.CreateIntensityAttr(spec["intensity_cd"] / (math.pi * LAMP_RADIUS_M**2))
    light.CreateColorAttr(Gf.Vec3f(*spec["color"]))
    light.CreateExtentAttr(box([[-LAMP_RADIUS_M] * 3, [LAMP_RADIUS_M] * 3]))
    UsdGeom.Xformable(light).AddTranslateOp().Set(Gf.Vec3d(*spec["position"]))


def define_camera(stage, pose):
    camera = UsdGeom.Camera.Define(stage, "/World/View")
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.05, 1000))
    camera.CreateFocalLengthAttr(18.0)
    place(camera, pose)


def place(prim, pose):
    prim.AddTranslateOp().Set(Gf.Vec3d(*pose["position"]))
    prim.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Quatd(*pose["orientation_wxyz"]))


def label(prim, labels):
    UsdSemantics.LabelsAPI.Apply(prim.GetPrim(), "class").CreateLabelsAttr(labels)


def box(corners):
    return Vt.Vec3fArray([Gf.Vec3f(*corner) for corner in corners])


def typed(value):
    """JSON with lists of three numbers converted to points, as `customLayerData` requires."""
    if isinstance(value, dict):
        return {key: typed(item) for key, item in value.items()}
    return Gf.Vec3d(*value) if isinstance(value, list) else value

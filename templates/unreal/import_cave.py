"""Imports a cave into an Unreal Engine project: textures, materials, meshes, collision and a level.

In the editor's command box: `py <this folder>/import_cave.py`, or without the editor window:
`UnrealEditor-Cmd Project.uproject -run=pythonscript -script=<this folder>/import_cave.py`. Needs the plugin Python Editor
Script Plugin. Assets land in `/Game/Plume/<name>`, or in the content folder that is given as an argument. A second run
replaces what the first has made, and keeps what you have added to the level yourself.
"""

from __future__ import annotations  # Unreal 5.3 brings Python 3.9

import json
import sys
from pathlib import Path
from typing import Any

import unreal

PACKAGE = Path(__file__).resolve().parent
TAG = "plume"  # Marks our actors, which the next run replaces.
#: Half the height of the capsule of a PlayerStart, whose origin is its centre.
HALF_PLAYER_CM = 92.0
#: Tolerance between the bounds of an imported mesh and those in scene.json. Wrong units or axes are off by metres.
BOX_TOLERANCE_CM = 10.0

PACKED = unreal.TextureCompressionSettings
GROUP = unreal.TextureGroup
#: sRGB, compression and group of each texture. Normal maps have the green channel of DirectX, so it is not flipped.
TEXTURES = {
    "base_color": (True, PACKED.TC_DEFAULT, GROUP.TEXTUREGROUP_WORLD),
    "normal": (False, PACKED.TC_NORMALMAP, GROUP.TEXTUREGROUP_WORLD_NORMAL_MAP),
    "orm": (False, PACKED.TC_MASKS, GROUP.TEXTUREGROUP_WORLD_SPECULAR),
}
SAMPLER = unreal.MaterialSamplerType
INPUT = unreal.MaterialProperty
#: The texture parameters of the material, and the inputs their channels are connected to.
PARAMETERS = {
    "base_color": (SAMPLER.SAMPLERTYPE_COLOR, {"RGB": INPUT.MP_BASE_COLOR}),
    "normal": (SAMPLER.SAMPLERTYPE_NORMAL, {"RGB": INPUT.MP_NORMAL}),
    "orm": (
        SAMPLER.SAMPLERTYPE_MASKS,
        {"R": INPUT.MP_AMBIENT_OCCLUSION, "G": INPUT.MP_ROUGHNESS, "B": INPUT.MP_METALLIC},
    ),
}


def main(root: str | None) -> None:
    """Imports the package into the content folder `root`."""
    scene = json.loads((PACKAGE / "scene.json").read_text(encoding="utf-8"))
    name = scene["name"]
    root = (root or f"/Game/Plume/{name}").rstrip("/")
    # Without the editor window the assets of an earlier run have not been discovered yet.
    unreal.AssetRegistryHelpers.get_asset_registry().scan_paths_synchronous([root], True)
    rock = make_asset(f"{root}/Materials/PM_{name}", unreal.PhysicalMaterial, unreal.PhysicalMaterialFactoryNew())
    change(rock, friction=scene["friction"], restitution=0.0)
    material = None
    instances: dict[str, unreal.MaterialInstanceConstant] = {}
    meshes = {}
    for part in scene["chunks"] + scene["things"]:
        if part["material"] not in instances:
            textures = {role: import_texture(path, role, root) for role, path in part["textures"].items()}
            # Where smaller mip levels average normals away, rock becomes rougher instead of glittering.
            green = unreal.CompositeTextureMode.CTM_NORMAL_ROUGHNESS_TO_GREEN
            change(textures["orm"], composite_texture=textures["normal"], composite_texture_mode=green)
            material = material or make_material(f"{root}/Materials/M_{name}", textures, rock)
            place = f"{root}/Materials/MI_{part['material']}"
            instances[part["material"]] = make_instance(place, textures, material)
        meshes[part["name"]] = mesh = import_part(part, f"{root}/Meshes/SM_{part['name']}", scene["nanite"])
        mesh.set_material(0, instances[part["material"]])
        set_collision(part, mesh, rock, f"{root}/Meshes/SM_{part['name']}_collision")
    for folder in ("Textures", "Materials", "Meshes"):
        assets = unreal.get_editor_subsystem(unreal.EditorAssetSubsystem)
        check(assets.save_directory(f"{root}/{folder}", True, True), f"{root}/{folder} was not saved")
    make_level(f"{root}/L_{name}", scene, meshes)
    things = sum(len(thing["instances"]) for thing in scene["things"])
    unreal.log(f"plume: {len(scene['chunks'])} chunks and {things} things of {name} are in {root}")


def check(result: Any, otherwise: str) -> Any:
    """The result of Unreal, or an error if there is none."""
    if not result:
        raise RuntimeError(f"plume: {otherwise}")
    return result


def change(thing: Any, **properties: Any) -> Any:
    """Sets several properties in one call, so that Unreal rebuilds the object only once."""
    thing.set_editor_properties(properties)
    return thing


def import_file(path: str, place: str, **how: Any) -> Any:
    """Imports a file of the package as the asset `place`, replacing an older one."""
    folder, name = place.rsplit("/", 1)
    task = change(unreal.AssetImportTask(), destination_path=folder, destination_name=name, automated=True)
    change(task, filename=str(PACKAGE / path), replace_existing=True, replace_existing_settings=True, **how)
    unreal.AssetToolsHelpers.get_asset_tools().import_asset_tasks([task])
    return check(unreal.load_asset(place), f"{path} was not imported: see the log above")


def import_texture(path: str, role: str, root: str) -> unreal.Texture2D:
    """Imports an image and sets what kind of texture it is."""
    # Newer engines name an image after its file, whatever name is requested.
    texture = import_file(path, f"{root}/Textures/{Path(path).stem}")
    srgb, compression, group = TEXTURES[role]
    # A project may turn large images into virtual textures, which the samplers of our material cannot read.
    change(texture, virtual_texture_streaming=False, srgb=srgb, compression_settings=compression, lod_group=group)
    return texture


def exists(place: str) -> bool:
    """Whether there is an asset or a level of this name."""
    return bool(unreal.AssetRegistryHelpers.get_asset_registry().get_assets_by_package_name(place))


def make_asset(place: str, kind: type, factory: unreal.Factory) -> Any:
    """The asset `place`, created if missing."""
    if exists(place):
        return check(unreal.load_asset(place), f"{place} cannot be loaded")
    folder, name = place.rsplit("/", 1)
    tools = unreal.AssetToolsHelpers.get_asset_tools()
    return check(tools.create_asset(name, folder, kind, factory), f"{place} cannot be made")


def make_material(place: str, textures: dict[str, Any], rock: unreal.PhysicalMaterial) -> unreal.Material:
    """The material of which every chunk has an instance; `textures` are placeholders for those of the chunks."""
    library = unreal.MaterialEditingLibrary
    material = make_asset(place, unreal.Material, unreal.MaterialFactoryNew())
    library.delete_all_material_expressions(material)
    change(material, phys_material=rock, used_with_nanite=True, used_with_instanced_static_meshes=True)
    for row, (role, (sampler, pins)) in enumerate(PARAMETERS.items()):
        kind = unreal.MaterialExpressionTextureSampleParameter2D
        node = library.create_material_expression(material, kind, -400, 300 * row)
        change(node, parameter_name=role, texture=textures[role], sampler_type=sampler)
        for pin, target in pins.items():
            check(library.connect_material_property(node, pin, target), f"{role}.{pin} cannot be connected")
    library.recompile_material(material)
    return material


def make_instance(place: str, textures: dict[str, Any], material: unreal.Material) -> unreal.MaterialInstanceConstant:
    """The material of a chunk or of things."""
    library = unreal.MaterialEditingLibrary
    instance = make_asset(place, unreal.MaterialInstanceConstant, unreal.MaterialInstanceConstantFactoryNew())
    library.set_material_instance_parent(instance, material)
    for role, texture in textures.items():
        library.set_material_instance_texture_parameter_value(instance, role, texture)
        check(library.get_material_instance_texture_parameter_value(instance, role) == texture, f"{place} lacks {role}")
    library.update_material_instance(instance)
    return instance


def import_mesh(path: str, place: str, *, nanite: bool, lods: bool, normals: unreal.FBXNormalImportMethod) -> Any:
    """Imports an FBX as a single static mesh whose origin is that of the cave."""
    kind = unreal.FBXImportType.FBXIT_STATIC_MESH
    options = change(unreal.FbxImportUI(), automated_import_should_detect_type=False, import_mesh=True)
    change(options, mesh_type_to_import=kind, import_as_skeletal=False, import_animations=False)
    change(options, import_materials=False, import_textures=False, auto_compute_lod_distances=False)
    data = options.get_editor_property("static_mesh_import_data")
    change(data, convert_scene=True, convert_scene_unit=True, force_front_x_axis=False)
    change(data, combine_meshes=True, transform_vertex_to_absolute=True, import_mesh_lo_ds=lods, build_nanite=nanite)
    change(data, normal_import_method=normals, normal_generation_method=unreal.FBXNormalGenerationMethod.MIKK_T_SPACE)
    # There are no degenerate triangles, but without this option the importer does not make triangles collide.
    change(data, generate_lightmap_u_vs=False, remove_degenerates=True)
    change(data, auto_generate_collision=False, one_convex_hull_per_ucx=True)
    # Without an explicit factory, newer engines would import FBX with Interchange, which reads other options.
    return import_file(path, place, factory=unreal.FbxFactory(), options=options)


def import_part(part: dict[str, Any], place: str, nanite: bool) -> unreal.StaticMesh:
    """Imports a chunk or a thing with its levels of detail, and warns if the result is not as expected."""
    levels = part["lods"]
    normals = unreal.FBXNormalImportMethod.FBXNIM_IMPORT_NORMALS_AND_TANGENTS
    mesh = import_mesh(part["mesh"], place, nanite=nanite, lods=len(levels) > 1, normals=normals)
    editor = unreal.get_editor_subsystem(unreal.StaticMeshEditorSubsystem)
    editor.set_lod_screen_sizes(mesh, [level["screen_size"] for level in levels])
    # A reimported mesh keeps its Nanite settings.
    editor.set_nanite_settings(mesh, change(editor.get_nanite_settings(mesh), enabled=nanite), True)
    box = mesh.get_bounding_box()
    is_now = [box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z]
    # No `strict`: Python 3.9 does not have it.
    off_cm = max(abs(a - b) for a, b in zip(is_now, part["min_cm"] + part["max_cm"]))  # noqa: B905
    if off_cm > BOX_TOLERANCE_CM:
        unreal.log_warning(f"plume: {part['name']} is {off_cm:.0f} cm away from its place: wrong units or axes?")
    for what, is_now, meant in (
        ("levels of detail", editor.get_lod_count(mesh), len(levels)),
        ("convex pieces", editor.get_convex_collision_count(mesh), part["convex_pieces"]),
    ):
        if is_now != meant:
            unreal.log_warning(f"plume: {part['name']} has {is_now} {what}, expected {meant}")
    return mesh


def set_collision(part: dict[str, Any], mesh: unreal.StaticMesh, rock: unreal.PhysicalMaterial, place: str) -> None:
    """Makes bodies collide with the collision mesh, or with the convex pieces imported with the mesh."""
    body = check(mesh.get_editor_property("body_setup"), f"{part['name']} has no body")
    flags = unreal.CollisionTraceFlag
    touched = None
    if part["collision_mesh"]:
        normals = unreal.FBXNormalImportMethod.FBXNIM_COMPUTE_NORMALS
        touched = import_mesh(part["collision_mesh"], place, nanite=False, lods=False, normals=normals)
    flag = flags.CTF_USE_COMPLEX_AS_SIMPLE if touched else flags.CTF_USE_DEFAULT
    change(body, collision_trace_flag=flag, phys_material=rock)
    change(mesh, complex_collision_mesh=touched)


def make_level(place: str, scene: dict[str, Any], meshes: dict[str, unreal.StaticMesh]) -> None:
    """A level with the chunks, the things, the lights, a PlayerStart at each pose and a TargetPoint at each station."""
    open_level(place)
    for chunk in scene["chunks"]:
        actor = spawn(unreal.StaticMeshActor, chunk["name"], [0.0, 0.0, 0.0])
        component = actor.get_component_by_class(unreal.StaticMeshComponent)
        show(component, meshes[chunk["name"]])
        if not chunk["collision_mesh"] and not chunk["convex_pieces"]:
            component.set_collision_profile_name("NoCollision")
    for thing in scene["things"]:
        add_instances(thing, meshes[thing["name"]])
    for pose in scene["spawns"]:
        x, y, z = pose["location_cm"]
        turn = unreal.Rotator(**pose["rotation_deg"])
        change(spawn(unreal.PlayerStart, pose["name"], [x, y, z + HALF_PLAYER_CM], turn), player_start_tag=pose["name"])
    for station in scene["stations"]:
        change(spawn(unreal.TargetPoint, station["name"], station["location_cm"]), tags=[TAG, station["station"]])
    for light in scene["lights"]:
        add_light(light)
    check(unreal.get_editor_subsystem(unreal.LevelEditorSubsystem).save_current_level(), f"{place} was not saved")


def show(component: unreal.StaticMeshComponent, mesh: unreal.StaticMesh) -> None:
    """Makes a component show a mesh, with which everything collides."""
    component.set_static_mesh(mesh)
    component.set_collision_profile_name("BlockAll")


def add_instances(thing: dict[str, Any], mesh: unreal.StaticMesh) -> None:
    """Adds an actor that shows a mesh at the place of each thing."""
    actor = spawn(unreal.Actor, thing["name"], [0.0, 0.0, 0.0])
    objects = unreal.get_engine_subsystem(unreal.SubobjectDataSubsystem)
    root = objects.k2_gather_subobject_data_for_instance(actor)[0]
    kind = unreal.HierarchicalInstancedStaticMeshComponent
    handle, why = objects.add_new_subobject(unreal.AddNewSubobjectParams(parent_handle=root, new_class=kind))
    library = unreal.SubobjectDataBlueprintFunctionLibrary
    component = check(library.get_object(library.get_data(handle)), f"{thing['name']} gets no instances: {why}")
    show(component, mesh)
    places = []
    for pose in thing["instances"]:
        turn, size = unreal.Rotator(**pose["rotation_deg"]), unreal.Vector(*[pose["scale"]] * 3)
        places.append(unreal.Transform(unreal.Vector(*pose["location_cm"]), turn, size))
    component.add_instances(places, False, True)
    check(component.get_instance_count() == len(places), f"{thing['name']} lacks instances")


def open_level(place: str) -> None:
    """Opens the level of an earlier run and removes our actors from it, or creates a new one."""
    levels = unreal.get_editor_subsystem(unreal.LevelEditorSubsystem)
    check(levels.load_level(place) if exists(place) else levels.new_level(place), f"{place} cannot be opened")
    actors = unreal.get_editor_subsystem(unreal.EditorActorSubsystem)
    for actor in actors.get_all_level_actors():
        if actor.actor_has_tag(TAG):
            actors.destroy_actor(actor)


def spawn(kind: type, label: str, location_cm: list[float], turn: unreal.Rotator | None = None) -> unreal.Actor:
    """Creates an actor with our tag."""
    actors = unreal.get_editor_subsystem(unreal.EditorActorSubsystem)
    location = unreal.Vector(*location_cm)
    actor = check(actors.spawn_actor_from_class(kind, location, turn or unreal.Rotator()), f"{label} cannot be placed")
    actor.set_actor_label(label)
    return change(actor, tags=[TAG])


def add_light(light: dict[str, Any]) -> None:
    """Adds a point light that needs no baking."""
    lamp = spawn(unreal.PointLight, light["name"], light["location_cm"])
    component = lamp.get_component_by_class(unreal.PointLightComponent)
    component.set_mobility(unreal.ComponentMobility.MOVABLE)
    component.set_intensity_units(unreal.LightUnits.CANDELAS)
    component.set_intensity(light["intensity_cd"])
    component.set_attenuation_radius(light["attenuation_radius_cm"])
    component.set_light_color(unreal.LinearColor(*light["color"], 1.0))


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)

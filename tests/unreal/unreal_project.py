"""An empty Unreal project: as much of an editor as the import script needs, behind the stub of `unreal`.

It has a content folder, an importer and one open level. The importer takes from a mesh what the script asks for afterwards:
levels of detail, convex pieces, and the box in Unreal's frame. What becomes of pixels and triangles is not in it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from unreal_fbx import Fbx
from unreal_stub import Kind, Member, Refused, Stub, Thing, check_type, entry

SUBSYSTEMS = {"EditorActorSubsystem", "EditorAssetSubsystem", "LevelEditorSubsystem", "StaticMeshEditorSubsystem"}


class Project(Stub):
    """The project state: `assets` by path, actors by level, saved assets, and warnings."""

    def __init__(self) -> None:
        super().__init__()
        self.assets: dict[str, Thing] = {}
        self.levels: dict[str, list[Thing]] = {}
        self.level: str | None = None
        self.saved: set[str] = set()
        self.warnings: list[str] = []

    def do_get_editor_property(self, thing: Thing, name: str) -> Any:
        entry(thing.kind, "properties", name)
        return thing.fields.get(name)

    def do_set_editor_properties(self, thing: Thing, properties: dict[str, Any]) -> None:
        for name, value in properties.items():
            check_type(value, entry(thing.kind, "properties", name), f"{thing.kind}.{name}")
        thing.fields |= properties
        self.saved.discard(thing.label)

    def do_get_editor_subsystem(self, _: None, subsystem: Kind) -> Thing:
        if repr(subsystem) not in SUBSYSTEMS:
            raise Refused(f"{subsystem} is no subsystem of the editor")
        return self.thing(repr(subsystem), label=repr(subsystem))

    def do_get_engine_subsystem(self, _: None, subsystem: Kind) -> Thing:
        if repr(subsystem) != "SubobjectDataSubsystem":
            raise Refused(f"{subsystem} is no subsystem of the engine")
        return self.thing(repr(subsystem), label=repr(subsystem))

    def do_get_asset_tools(self, _: None) -> Thing:
        return self.thing("AssetTools", label="AssetTools")

    def do_get_asset_registry(self, _: None) -> Thing:
        return self.thing("AssetRegistry", label="AssetRegistry")

    def do_log_warning(self, _: None, arg: str) -> None:
        self.warnings.append(arg)

    # Assets.

    def do_load_asset(self, _: None, name: str) -> Thing | None:
        return self.assets.get(name)

    def do_get_assets_by_package_name(self, _: Thing, package_name: str) -> list[Thing]:
        return [self.thing("AssetData")] if package_name in self.assets or package_name in self.levels else []

    def do_save_directory(self, _: Thing, directory_path: str, only_if_is_dirty: bool, recursive: bool) -> bool:
        inside = {place for place in self.assets if place.startswith(f"{directory_path}/")}
        self.saved |= inside
        return bool(inside)

    def do_create_asset(self, _: Thing, asset_name: str, package_path: str, asset_class: Kind, factory: Thing) -> Thing:
        if factory.kind != f"{asset_class}FactoryNew":
            raise Refused(f"{factory} does not make {asset_class}")
        return self._keep(repr(asset_class), f"{package_path}/{asset_name}")

    def _keep(self, kind: str, place: str) -> Thing:
        if place in self.assets:
            raise Refused(f"{place} is there already")
        self.assets[place] = self.thing(kind, label=place)
        return self.assets[place]

    # Importing.

    def do_import_asset_tasks(self, _: Thing, import_tasks: list[Thing]) -> None:
        for task in (task.fields for task in import_tasks):
            place = f"{task['destination_path']}/{task['destination_name']}"
            if not task.get("automated"):
                raise Refused("an import that is not automated asks the user")
            if place in self.assets and not (task.get("replace_existing") and task.get("replace_existing_settings")):
                raise Refused(f"{place} is there already")
            # Unreal logs the error and continues.
            if Path(task["filename"]).is_file():
                self._import(place, Path(task["filename"]), task)

    def _import(self, place: str, path: Path, task: dict[str, Any]) -> None:
        if path.suffix == ".fbx":
            self._import_mesh(place, Fbx(path), task)
        elif place.endswith(f"/{path.stem}"):
            self.assets.setdefault(place, self.thing("Texture2D", label=place))
        else:
            raise Refused(f"Interchange calls {path.name} after its file")

    def _import_mesh(self, place: str, fbx: Fbx, task: dict[str, Any]) -> None:
        if task.get("factory") is None or task["factory"].kind != "FbxFactory":
            raise Refused("without the FBX factory, newer engines import FBX by Interchange")
        data = task["options"].fields["static_mesh_import_data"].fields
        levels = [name for name in fbx.nodes if not name.startswith("UCX_")]
        mesh = self.assets.get(place) or self._keep("StaticMesh", place)
        mesh.fields.setdefault("nanite", self.thing("MeshNaniteSettings", {"enabled": data["build_nanite"]}))
        mesh.fields |= {
            "import data": data,
            "body_setup": self.thing("BodySetup", label=f"{place}.body_setup"),
            "box": self._box(fbx, data),
            "levels": len(levels) if data["import_mesh_lo_ds"] else 1,
            "pieces": sum(name.startswith(f"UCX_{levels[0]}_") for name in fbx.nodes),
        }

    def _box(self, fbx: Fbx, data: dict[str, Any]) -> Thing:
        """The importer mirrors y of a file whose front is −Y, and turns others."""
        if not (data["convert_scene"] and fbx.front_is_minus_y and not data["force_front_x_axis"]):
            raise Refused("a mesh would be turned")
        scale = fbx.unit_cm if data["convert_scene_unit"] else 1.0
        axes = list(zip(*((scale * x, -scale * y, scale * z) for x, y, z in fbx.vertices), strict=True))
        corners = [[pick(axis) for axis in axes] for pick in (min, max)]
        low, high = (self.thing("Vector", dict(zip("xyz", corner, strict=True))) for corner in corners)
        return self.thing("Box", {"min": low, "max": high})

    def thing(self, kind: str, fields: dict[str, Any] | None = None, label: str | None = None) -> Thing:
        thing = super().thing(kind, fields, label)
        if kind == "FbxImportUI":
            thing.fields["static_mesh_import_data"] = self.thing("FbxStaticMeshImportData")
        return thing

    # Meshes.

    def do_get_bounding_box(self, mesh: Thing) -> Thing:
        return mesh.fields["box"]

    def do_get_lod_count(self, _: Thing, static_mesh: Thing) -> int:
        return static_mesh.fields["levels"]

    def do_get_convex_collision_count(self, _: Thing, static_mesh: Thing) -> int:
        return static_mesh.fields["pieces"]

    def do_get_nanite_settings(self, _: Thing, static_mesh: Thing) -> Thing:
        return self.thing("MeshNaniteSettings", dict(static_mesh.fields["nanite"].fields))

    def do_set_nanite_settings(self, _: Thing, static_mesh: Thing, nanite_settings: Thing, apply_changes: bool) -> None:
        static_mesh.fields["nanite"] = nanite_settings

    def do_set_lod_screen_sizes(self, _: Thing, static_mesh: Thing, screen_sizes: list[float]) -> bool:
        static_mesh.fields["screen sizes"] = screen_sizes
        return True

    def do_set_material(self, mesh: Thing, material_index: int, new_material: Thing) -> None:
        mesh.fields["material"] = new_material

    # Materials.

    def do_delete_all_material_expressions(self, _: None, material: Thing) -> None:
        material.fields["inputs"] = {}

    def do_create_material_expression(self, _: None, material: Thing, expression_class: Kind, **place: int) -> Thing:
        return self.thing(repr(expression_class), {"material": material})

    def do_connect_material_property(
        self, _: None, from_expression: Thing, from_output_name: str, property_: Member
    ) -> bool:
        source = f"{from_expression.fields['parameter_name']}.{from_output_name}"
        from_expression.fields["material"].fields["inputs"][property_.name] = source
        return True

    def do_set_material_instance_parent(self, _: None, instance: Thing, new_parent: Thing) -> None:
        instance.fields["parent"] = new_parent

    def do_set_material_instance_texture_parameter_value(
        self, _: None, instance: Thing, parameter_name: str, value: Thing
    ) -> bool:
        instance.fields.setdefault("textures", {})[parameter_name] = value
        # Unreal is known to report this in any case.
        return False

    def do_get_material_instance_texture_parameter_value(self, _: None, instance: Thing, parameter_name: str) -> Thing:
        return instance.fields["textures"].get(parameter_name)

    # The level.

    def do_new_level(self, _: Thing, asset_path: str) -> bool:
        self.level, self.levels[asset_path] = asset_path, []
        return True

    def do_load_level(self, _: Thing, asset_path: str) -> bool:
        self.level = asset_path
        return asset_path in self.levels

    def do_save_current_level(self, _: Thing) -> bool:
        self.saved.add(self.level)
        return True

    def do_get_all_level_actors(self, _: Thing) -> list[Thing]:
        return list(self.levels[self.level])

    def do_destroy_actor(self, _: Thing, actor_to_destroy: Thing) -> bool:
        self.levels[self.level].remove(actor_to_destroy)
        return True

    def do_spawn_actor_from_class(self, _: Thing, actor_class: Kind, location: Thing, rotation: Thing) -> Thing:
        actor = self.thing(repr(actor_class), {"location": location, "rotation": rotation})
        self.levels[self.level].append(actor)
        self.saved.discard(self.level)
        return actor

    def do_set_actor_label(self, actor: Thing, new_actor_label: str) -> None:
        actor.fields["label"] = new_actor_label

    def do_actor_has_tag(self, actor: Thing, tag: str) -> bool:
        return tag in actor.fields.get("tags", [])

    def do_get_component_by_class(self, actor: Thing, component_class: Kind) -> Thing | None:
        if repr(component_class) != f"{actor.kind.removesuffix('Actor')}Component":
            return None
        return actor.fields.setdefault("component", self.thing(repr(component_class)))

    def do_set_static_mesh(self, component: Thing, new_mesh: Thing) -> bool:
        component.fields["mesh"] = new_mesh
        return True

    # Components of actors.

    def do_k2_gather_subobject_data_for_instance(self, _: Thing, context: Thing) -> list[Thing]:
        return [self.thing("SubobjectDataHandle", {"actor": context, "object": context})]

    def do_add_new_subobject(self, _: Thing, params: Thing) -> tuple[Thing, str]:
        actor = params.fields["parent_handle"].fields["actor"]
        actor.fields["component"] = component = self.thing(repr(params.fields["new_class"]))
        return self.thing("SubobjectDataHandle", {"actor": actor, "object": component}), ""

    def do_get_data(self, _: None, data_handle: Thing) -> Thing:
        return self.thing("SubobjectData", data_handle.fields)

    def do_get_object(self, _: None, data: Thing) -> Thing:
        return data.fields["object"]

    def do_add_instances(
        self, component: Thing, instance_transforms: list[Thing], should_return_indices: bool, world_space: bool
    ) -> list[int]:
        if not world_space:
            raise Refused("where the component is, depends on its actor")
        component.fields.setdefault("instances", []).extend(instance_transforms)
        return []

    def do_get_instance_count(self, component: Thing) -> int:
        return len(component.fields.get("instances", []))

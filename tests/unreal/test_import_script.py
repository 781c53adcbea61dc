"""The import script of Unreal packages, run on the sample scene under the stub of `unreal`.

Every call is compared with the list in `calls.txt`; `UPDATE_CALLS=1` writes it anew, for a human to read the difference.
"""

import ast
import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from unreal_project import Project
from unreal_stub import API, Refused

ROOT = Path(__file__).parents[2]
CALLS = Path(__file__).with_name("calls.txt")
HOME = "/Game/Plume/chamber"
CHUNKS = ["chunk_0_0_0", "chunk_1_0_0"]


@pytest.fixture(scope="session")
def samples(tmp_path_factory):
    """Packages of the sample scene: `unreal` with triangles to touch, `unreal_pieces` with pieces, `unreal_things` with things."""
    if "PLUME_SCENE" in os.environ:  # `cargo xtask` has written it
        return Path(os.environ["PLUME_SCENE"])
    folder = tmp_path_factory.mktemp("samples")
    example = ["cargo", "run", "--quiet", "-p", "plume-exporters", "--example", "sample_package", "--", str(folder)]
    subprocess.run(example, cwd=ROOT, check=True)
    return folder


@pytest.fixture
def package(samples, tmp_path):
    """A package that may be spoilt."""
    return shutil.copytree(samples / "unreal", tmp_path / "unreal")


@pytest.fixture
def strewn(samples, tmp_path):
    """A package with things, which may be spoilt."""
    return shutil.copytree(samples / "unreal_things", tmp_path / "unreal_things")


def run(package, project=None, *arguments):
    """Runs the script of a package in a project, and returns the project."""
    project = project or Project()
    path = package / "import_cave.py"
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "unreal", project.module())
        patch.setattr(sys, "argv", [str(path), *arguments])
        exec(compile(path.read_text(encoding="utf-8"), path, "exec"), {"__file__": str(path), "__name__": "__main__"})
    project.calls = [call.replace(str(package.resolve()), "<package>") for call in project.calls]
    return project


def mesh(project, chunk):
    return project.assets[f"{HOME}/Meshes/SM_{chunk}"]


def actors(project, kind):
    return [actor for actor in project.levels[f"{HOME}/L_chamber"] if actor.kind == kind]


def place(actor):
    return [actor.fields["location"].fields[axis] for axis in "xyz"]


def scene(package):
    return json.loads((package / "scene.json").read_text(encoding="utf-8"))


def test_every_call_is_listed(strewn):
    calls = "\n".join(run(strewn).calls) + "\n"
    if os.environ.get("UPDATE_CALLS"):
        CALLS.write_text(calls, encoding="utf-8")
    assert calls == CALLS.read_text(encoding="utf-8")


def test_every_chunk_becomes_a_mesh_with_its_material(package):
    project = run(package)
    assert project.warnings == []
    for chunk in CHUNKS:
        material = mesh(project, chunk).fields["material"]
        assert material.label == f"{HOME}/Materials/MI_{chunk}"
        assert material.fields["parent"].label == f"{HOME}/Materials/M_chamber"
        textures = {role: f"{HOME}/Textures/{chunk}_{role}" for role in ("base_color", "normal", "orm")}
        assert {role: texture.label for role, texture in material.fields["textures"].items()} == textures


@pytest.mark.parametrize(
    ("role", "srgb", "compression"),
    [("base_color", True, "TC_DEFAULT"), ("normal", False, "TC_NORMALMAP"), ("orm", False, "TC_MASKS")],
)
def test_textures_are_what_they_hold(package, role, srgb, compression):
    project = run(package)
    for chunk in CHUNKS:
        texture = project.assets[f"{HOME}/Textures/{chunk}_{role}"].fields
        assert texture["srgb"] is srgb
        assert texture["compression_settings"].name == compression
        assert texture["virtual_texture_streaming"] is False


def test_channels_of_the_textures_go_where_they_belong(package):
    assert run(package).assets[f"{HOME}/Materials/M_chamber"].fields["inputs"] == {
        "MP_BASE_COLOR": "base_color.RGB",
        "MP_NORMAL": "normal.RGB",
        "MP_AMBIENT_OCCLUSION": "orm.R",
        "MP_ROUGHNESS": "orm.G",
        "MP_METALLIC": "orm.B",
    }


def test_triangles_collide_as_the_collision_mesh(package):
    project = run(package)
    for chunk in CHUNKS:
        fields = mesh(project, chunk).fields
        assert fields["body_setup"].fields["collision_trace_flag"].name == "CTF_USE_COMPLEX_AS_SIMPLE"
        touched = fields["complex_collision_mesh"]
        assert touched.label == f"{HOME}/Meshes/SM_{chunk}_collision"
        assert touched.fields["nanite"].fields == {"enabled": False}
        # The importer lets triangles collide only then.
        assert touched.fields["import data"]["remove_degenerates"] is True


def test_pieces_collide_as_simple_shapes(samples):
    project = run(samples / "unreal_pieces")
    assert project.warnings == []
    for chunk, entry in zip(CHUNKS, scene(samples / "unreal_pieces")["chunks"], strict=True):
        fields = mesh(project, chunk).fields
        assert fields["pieces"] == entry["convex_pieces"] > 0
        assert fields["import data"]["one_convex_hull_per_ucx"] is True
        assert fields["body_setup"].fields["collision_trace_flag"].name == "CTF_USE_DEFAULT"
        assert fields["complex_collision_mesh"] is None


def test_rock_has_the_friction_of_the_scene(package):
    project = run(package)
    rock = project.assets[f"{HOME}/Materials/PM_chamber"]
    assert rock.fields == {"friction": 0.8, "restitution": 0.0}
    assert project.assets[f"{HOME}/Materials/M_chamber"].fields["phys_material"] is rock
    assert all(mesh(project, chunk).fields["body_setup"].fields["phys_material"] is rock for chunk in CHUNKS)


@pytest.mark.parametrize("nanite", [True, False])
def test_nanite_is_as_the_package_says_also_the_second_time(package, nanite):
    project = run(package)
    told = scene(package) | {"nanite": nanite}
    (package / "scene.json").write_text(json.dumps(told), encoding="utf-8")
    run(package, project)
    assert all(mesh(project, chunk).fields["nanite"].fields == {"enabled": nanite} for chunk in CHUNKS)


def test_levels_of_detail_have_their_sizes(package):
    project = run(package)
    for chunk, entry in zip(CHUNKS, scene(package)["chunks"], strict=True):
        sizes = mesh(project, chunk).fields["screen sizes"]
        assert sizes == [level["screen_size"] for level in entry["lods"]] and len(sizes) == 2
        assert mesh(project, chunk).fields["levels"] == 2


def test_the_level_has_everything_in_its_place(package):
    project = run(package)
    chunks = actors(project, "StaticMeshActor")
    assert [actor.fields["component"].fields["mesh"] for actor in chunks] == [mesh(project, chunk) for chunk in CHUNKS]
    assert [place(actor) for actor in chunks] == [[0, 0, 0]] * 2
    (start,) = actors(project, "PlayerStart")
    assert place(start) == pytest.approx([0, 0, -184 + 92])
    # The sample looks half a radian to the left, which is against Unreal's yaw.
    assert start.fields["rotation"].fields == pytest.approx({"roll": 0, "pitch": 0, "yaw": -28.64789})
    lamps = actors(project, "PointLight")
    assert [place(lamp) for lamp in lamps] == [[-300, 0, 100], [300, 0, 100]]


def test_named_stations_are_target_points(package):
    station = {"name": "station_hall_1", "station": "Hall.1", "location_cm": [100.0, -25.0, 50.0]}
    (package / "scene.json").write_text(json.dumps(scene(package) | {"stations": [station]}), encoding="utf-8")
    project = run(package)
    run(package, project)
    (point,) = actors(project, "TargetPoint")
    assert place(point) == station["location_cm"]
    assert (point.fields["label"], point.fields["tags"]) == ("station_hall_1", ["plume", "Hall.1"])


def instances(project):
    """The instances of the only mesh of things."""
    (actor,) = actors(project, "Actor")
    component = actor.fields["component"]
    assert component.kind == "HierarchicalInstancedStaticMeshComponent" and actor.fields["tags"] == ["plume"]
    assert component.fields["mesh"] is mesh(project, "box_0_level0")
    return [instance.fields for instance in component.fields["instances"]]


def test_things_are_instances_of_one_mesh(strewn):
    project = run(strewn)
    assert project.warnings == []
    listed = json.loads((strewn / "instances.json").read_text(encoding="utf-8"))["things"]
    found = instances(project)
    assert len(found) == len(listed) == 3
    for thing, instance in zip(listed, found, strict=True):
        x, y, z = thing["position"]
        assert instance["location"].fields == pytest.approx({"x": 100 * x, "y": -100 * y, "z": 100 * z})
        assert set(instance["scale"].fields.values()) == {thing["scale"]}
        # The axes of the box, mirrored like everything else: Unreal's rotator turns them as the quaternion does.
        axes = rotated_axes(*thing["orientation_wxyz"])
        mirrored = [
            [sign * (-part if row == 1 else part) for row, part in enumerate(axis)]
            for sign, axis in zip((1, -1, 1), axes, strict=True)
        ]
        turned = rotator_axes(**instance["rotation"].fields)
        assert [part for axis in turned for part in axis] == pytest.approx(
            [part for axis in mirrored for part in axis], abs=1e-6
        )


def rotated_axes(w, x, y, z):
    """Where a unit quaternion turns x, y and z."""
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
        [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
        [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
    ]


def rotator_axes(roll, pitch, yaw):
    """Rows of Unreal's FRotationMatrix: where a rotator turns forward, right and up."""
    (sr, cr), (sp, cp), (sy, cy) = (
        (math.sin(math.radians(angle)), math.cos(math.radians(angle))) for angle in (roll, pitch, yaw)
    )
    return [
        [cp * cy, cp * sy, sp],
        [sr * sp * cy - cr * sy, sr * sp * sy + cr * cy, -sr * cp],
        [-(cr * sp * cy + sr * sy), cy * sr - cr * sp * sy, cr * cp],
    ]


def test_a_thing_has_levels_of_detail_a_hull_and_the_material_that_it_shares(strewn):
    project = run(strewn)
    (shape,) = scene(strewn)["things"]
    fields = mesh(project, "box_0_level0").fields
    assert fields["screen sizes"] == [level["screen_size"] for level in shape["lods"]]
    assert fields["levels"] == len(shape["lods"]) == 2 and fields["pieces"] == 1
    assert fields["body_setup"].fields["collision_trace_flag"].name == "CTF_USE_DEFAULT"
    assert fields["complex_collision_mesh"] is None
    assert fields["material"].label == f"{HOME}/Materials/MI_prototypes"
    assert fields["material"].fields["parent"].fields["used_with_instanced_static_meshes"] is True


def test_a_second_run_replaces_things(strewn):
    project = run(strewn)
    run(strewn, project)
    assert len(instances(project)) == 3 and project.warnings == []


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("add_instances(places, False, True)", "add_instances(places, False, False)", "depends on its actor"),
        ("add_instances(places, False, True)", "add_instance(places)", "no methods `add_instance`"),
        ("add_instances(places, False, True)", "add_instances(places[1:], False, True)", "lacks instances"),
    ],
)
def test_a_script_that_misplaces_things_is_refused(strewn, old, new, complaint):
    spoil(strewn, old, new)
    with pytest.raises((Refused, RuntimeError), match=complaint):
        run(strewn)


def test_everything_is_saved(package):
    project = run(package)
    assert project.saved == {*project.assets, f"{HOME}/L_chamber"}


def test_a_second_run_replaces_the_first_and_spares_what_is_not_ours(package):
    project = run(package)
    own = project.thing("StaticMeshActor", {"tags": ["mine"]})
    project.levels[f"{HOME}/L_chamber"].append(own)
    before = set(project.assets)
    run(package, project)
    assert set(project.assets) == before and own in project.levels[f"{HOME}/L_chamber"]
    assert [len(actors(project, kind)) for kind in ("StaticMeshActor", "PlayerStart", "PointLight")] == [3, 1, 2]
    assert project.saved == {*project.assets, f"{HOME}/L_chamber"} and project.warnings == []


def test_another_content_folder_can_be_named(package):
    project = run(package, None, "/Game/Elsewhere/")
    assert project.level == "/Game/Elsewhere/L_chamber"
    assert all(place.startswith("/Game/Elsewhere/") for place in project.assets)


def test_a_missing_file_is_told(package):
    (package / "meshes/chunk_1_0_0.fbx").unlink()
    with pytest.raises(RuntimeError, match=r"meshes/chunk_1_0_0\.fbx was not imported"):
        run(package)


def change_entry(package, **fields):
    told = scene(package)
    told["chunks"][1] |= fields
    (package / "scene.json").write_text(json.dumps(told), encoding="utf-8")


@pytest.mark.parametrize(
    ("fields", "warning"),
    [
        ({"min_cm": [0.0, -150.0, -192.0]}, "chunk_1_0_0 is 48 cm away from its place"),
        ({"convex_pieces": 7}, "chunk_1_0_0 has 0 convex pieces, expected 7"),
        ({"lods": [{"screen_size": 1.0}] * 3}, "chunk_1_0_0 has 2 levels of detail, expected 3"),
    ],
)
def test_a_mesh_that_is_not_what_was_meant_is_told(package, fields, warning):
    change_entry(package, **fields)
    (told,) = run(package).warnings
    assert warning in told


def spoil(package, old, new):
    script = package / "import_cave.py"
    text = script.read_text(encoding="utf-8")
    assert text.count(old) == 1
    script.write_text(text.replace(old, new), encoding="utf-8")


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("used_with_nanite=True", "use_with_nanite=True", "Material has no properties `use_with_nanite`"),
        ("import_mesh_lo_ds=lods", "import_mesh_LODs=lods", "has no properties `import_mesh_LODs`"),
        ("recompile_material(", "recompile(", "MaterialEditingLibrary has no functions `recompile`"),
        ("set_actor_label(", "set_label(", "StaticMeshActor has no methods `set_label`"),
        ("PACKED.TC_MASKS", "PACKED.TC_MASK", "TextureCompressionSettings has no member `TC_MASK`"),
        ("unreal.FbxFactory()", "unreal.FBXFactory()", "`unreal.FBXFactory` is not in the table"),
        ("restitution=0.0", 'restitution="none"', "PhysicalMaterial.restitution is float"),
        ("restitution=0.0", "restitution=False", "PhysicalMaterial.restitution is float"),
        ("mesh.set_material(0, ", "mesh.set_material(", "set_material takes"),
        ("factory=unreal.FbxFactory(), ", "", "import FBX by Interchange"),
        ("replace_existing=True, ", "", "is there already"),
        ("convert_scene=True, ", "convert_scene=False, ", "would be turned"),
        (", automated=True", "", "asks the user"),
        ("unreal.PointLightComponent)", "unreal.StaticMeshComponent)", "NoneType"),
    ],
)
def test_a_spoilt_script_is_refused(package, old, new, complaint):
    spoil(package, old, new)
    with pytest.raises((Refused, AttributeError), match=complaint):
        run(package, run(package))


@pytest.mark.parametrize(
    ("old", "new", "warning"),
    [
        ("convert_scene_unit=True", "convert_scene_unit=False", "away from its place"),
        ("import_mesh_lo_ds=lods", "import_mesh_lo_ds=False", "has 1 levels of detail, expected 2"),
    ],
)
def test_a_spoilt_import_is_told(package, old, new, warning):
    spoil(package, old, new)
    project = run(package)
    assert len(project.warnings) == len(CHUNKS) and all(warning in told for told in project.warnings)


def test_the_script_is_small_and_speaks_the_python_of_unreal_5_3(package):
    text = (package / "import_cave.py").read_text(encoding="utf-8")
    ast.parse(text, feature_version=(3, 9))
    assert len(text.splitlines()) <= 300


def test_nothing_of_the_table_is_idle(samples, package):
    """What the script no longer uses has no place in the table."""
    project = run(samples / "unreal_things", run(samples / "unreal_pieces"))
    run(package, project)
    run(package, project)
    used = "\n".join(project.calls)
    for kind, what in API["classes"].items():
        names = [name for section in ("functions", "methods", "properties") for name in what.get(section, {})]
        assert [name for name in names if name not in used] == [], kind

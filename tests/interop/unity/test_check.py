"""What is broken in a package for Unity must be noticed: `cargo xtask interop` runs this, with the scene in PLUME_SCENE."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

CHECK = Path(__file__).with_name("check.py")


@pytest.fixture(scope="session")
def sample():
    """The sample scene for every target, `unity` and `gltf` among them."""
    return Path(os.environ["PLUME_SCENE"])


def verify(package):
    result = subprocess.run([sys.executable, CHECK, package], capture_output=True, text=True)
    return result.returncode, result.stdout + result.stderr


def replace(file, old, new, count=1):
    """Rewrites a text of the package."""

    def change(package):
        path = package / "Runtime" / file
        text, found = re.subn(old, new, path.read_text(), count=count, flags=re.MULTILINE)
        assert found
        path.write_text(text)

    return change


def remove(file):
    return lambda package: (package / file).unlink()


def add(file):
    return lambda package: (package / file).write_text("")


def copy(source, file):
    return lambda package: shutil.copy(package / source, package / file)


def metal(package):
    path = package / "Runtime/Textures/chunk_0_0_0_mask.png"
    pixels = np.array(Image.open(path))
    pixels[..., 0] = 255
    Image.fromarray(pixels).save(path)


def opaque(package):
    path = package / "Runtime/Textures/chunk_0_0_0_mask.png"
    Image.open(path).convert("RGB").save(path)


def manifest(key, value):
    def change(package):
        path = package / "package.json"
        path.write_text(json.dumps({**json.loads(path.read_text()), key: value}))

    return change


def lose_a_thing(package):
    path = package / "instances.json"
    told = json.loads(path.read_text())
    path.write_text(json.dumps({**told, "things": told["things"][:2]}))


CHUNK = "chunk_0_0_0"
PREFAB, MATERIAL, MODEL = "chamber.prefab", f"Materials/{CHUNK}.mat", f"Meshes/{CHUNK}.fbx.meta"
TEXTURES = {role: f"Textures/{CHUNK}_{role}.png.meta" for role in ("base_color", "normal", "mask")}

FAULTS = {
    "a GUID that no asset has": (replace(MATERIAL, r"(_BumpMap:\n.*guid: )\w{32}", rf"\g<1>{'ab' * 16}"), "not there: abab"),
    "a missing .meta": (remove(f"Runtime/Textures/{CHUNK}_mask.png.meta"), "has no .meta"),
    "a folder without a .meta": (remove("Runtime/Meshes.meta"), "Meshes has no .meta"),
    "a .meta of nothing": (add("Runtime/lost.png.meta"), "belong to nothing"),
    "two assets of one GUID": (copy(f"Runtime/{MODEL}", "Runtime/Meshes/chunk_1_0_0.fbx.meta"), "two assets have the GUID"),
    "a GUID in capitals": (replace(TEXTURES["mask"], r"^guid: \w{4}", "guid: ABCD"), "no GUID of 32"),
    "a normal map that is read as colour": (replace(TEXTURES["normal"], "textureType: 1", "textureType: 0"), "of textureType 0"),
    "a mask in sRGB": (replace(TEXTURES["mask"], "sRGBTexture: 0", "sRGBTexture: 1"), "sRGBTexture must be 0"),
    "a base colour that is linear": (replace(TEXTURES["base_color"], "sRGBTexture: 1", "sRGBTexture: 0"), "must be 1"),
    "normals of DirectX": (replace(TEXTURES["normal"], "flipGreenChannel: 0", "flipGreenChannel: 1"), "green turned"),
    "an image that is made smaller": (replace(TEXTURES["mask"], "maxTextureSize: 64", "maxTextureSize: 32"), "larger than"),
    "stone of metal": (metal, "stone is metal"),
    "a mask without smoothness": (opaque, "no alpha"),
    "an object that is not there": (replace(PREFAB, r"- component: \{fileID: \d+", "- component: {fileID: 7"), "not there: 7"),
    "an object of another class": (replace(PREFAB, "!u!205", "!u!95"), "which is None"),
    "a class that is called otherwise": (replace(PREFAB, "^LODGroup:", "LodGroup:"), "which is LODGroup"),
    "an object without a field": (replace(PREFAB, r"^  m_Size: .*\n", ""), "has no m_Size"),
    "a field of another type": (replace(PREFAB, "m_Convex: 0", "m_Convex: never"), "is no 0 or 1"),
    "a mesh that is not in the FBX": (replace(PREFAB, r"m_Mesh: \{fileID: -?\d+", "m_Mesh: {fileID: 4300000"), "names what"),
    "a table of other meshes": (replace(MODEL, f"second: {CHUNK}_LOD1", f"second: {CHUNK}_LOD9"), "not in it"),
    "a material that the FBX has not": (replace(MODEL, f"name: {CHUNK}$", "name: rock"), "no material called rock"),
    "a model in centimetres": (replace(MODEL, "globalScale: 1", "globalScale: 0.01"), "globalScale 0.01"),
    "levels in a wrong order": (replace(PREFAB, "screenRelativeHeight: 0$", "screenRelativeHeight: 0.9"), "levels change at"),
    "a child of another father": (replace(PREFAB, r"m_Father: \{fileID: [1-9]\d*", "m_Father: {fileID: 0"), "another father"),
    "a shader without its keyword": (replace(MATERIAL, "  - _NORMALMAP\n", ""), "wants the keywords"),
    "an unknown shader": (replace(MATERIAL, "933532a4", "033532a4"), "not there: 033532a4"),
    "no tag of Unity": (replace(PREFAB, "^%TAG.*\n", ""), "does not begin"),
    "a start pose in the air": (replace(PREFAB, r"(x: -?0, y: )-1\.\d+", r"\g<1>-1.2"), "m above the floor"),
    "a start pose on its side": (replace(PREFAB, r"m_LocalRotation: \{x: 0, y: -?0\.\d+.*", "m_LocalRotation: {x: 1, y: 0, z: 0, w: 0}"), "does not stand"),
    "a light outside": (replace(PREFAB, r"m_LocalPosition: \{x: -?3, y: 1,", "m_LocalPosition: {x: 30, y: 1,"), "not in the cave"),
    "a name that the Package Manager refuses": (manifest("name", "com.plume.Chamber"), "has a name that is none"),
    "a version that is none": (manifest("version", "1.0"), "has a version that is none"),
}  # fmt: skip


# Of a package with things, three boxes.
BOX = "Things/box_0_level0_movable.prefab"
FAULTS_OF_THINGS = {
    "a thing too few in the list": (lose_a_thing, "has 3 things, and instances.json lists 2"),
    "a thing elsewhere": (replace(PREFAB, r"(m_LocalPosition.x\n +value: )-1\b", r"\g<1>-1.5"), "0.500 m away from its place"),
    "a thing in the frame of the scene": (replace(PREFAB, r"(m_LocalRotation.y\n +value: )-", r"\g<1>"), "turned otherwise"),
    "a thing of another size": (replace(PREFAB, r"(m_LocalScale.z\n +value: )1.5", r"\g<1>1"), "has the scale"),
    "a thing of another mass": (replace(PREFAB, r"(m_Mass\n +value: )2", r"\g<1>3"), "has 3 kg"),
    "a thing whose name another has": (replace(PREFAB, r"box_0+2$", "box_0000000000000000"), "two things are called"),
    "a thing below nothing": (replace(PREFAB, r"  m_Children:\n  - .*\n(  - .*\n  - .*\n  m_Father: .*\n  m_RootOrder: 2)", r"  m_Children:\n\1"), "is no child of its father"),
    "a prefab that nothing names": (replace(PREFAB, r"fileID: 100100000", "fileID: 100100001"), "names what"),
    "a stone that does not fall": (replace(BOX, "m_UseGravity: 1", "m_UseGravity: 0"), "does not fall"),
    "a body that is hollow": (replace(BOX, "m_Convex: 1", "m_Convex: 0"), "no convex collider"),
    "a body that is static": (replace(BOX, "m_StaticEditorFlags: 0", "m_StaticEditorFlags: 90"), "static and moves"),
}  # fmt: skip


@pytest.mark.parametrize("package", ["unity", "unity_pieces", "unity_things"])
def test_a_good_package_passes(package, sample):
    code, said = verify(sample / package)
    assert code == 0 and "1 start poses" in said, said


@pytest.mark.parametrize("fault", FAULTS)
def test_a_faulty_package_fails(fault, sample, tmp_path):
    change, message = FAULTS[fault]
    shutil.copytree(sample / "unity", tmp_path / "unity")
    change(tmp_path / "unity")
    code, said = verify(tmp_path / "unity")
    assert code == 1 and message in said, said


@pytest.mark.parametrize("fault", FAULTS_OF_THINGS)
def test_a_package_with_a_faulty_thing_fails(fault, sample, tmp_path):
    change, message = FAULTS_OF_THINGS[fault]
    shutil.copytree(sample / "unity_things", tmp_path / "unity")
    change(tmp_path / "unity")
    code, said = verify(tmp_path / "unity")
    assert code == 1 and message in said, said


def test_masks_say_what_the_images_of_the_same_scene_as_gltf_say(sample):
    images = sorted((sample / "gltf/textures").glob("*_orm.png"))
    assert len(images) == 2
    for image in images:
        orm = np.array(Image.open(image).convert("RGB"))
        mask = np.array(Image.open(sample / "unity/Runtime/Textures" / image.name.replace("_orm", "_mask")))
        expected = np.stack([orm[..., 2], orm[..., 0], 0 * orm[..., 0], 255 - orm[..., 1]], axis=-1)
        assert np.array_equal(mask, expected), image.name

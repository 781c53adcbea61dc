"""Holds a package for Unity to what Unity documents: `check.py PACKAGE_DIR`.

Unity itself is not asked. Its YAML is read by PyYAML, its models by assimp, its images by Pillow.
"""

import json
import sys
from pathlib import Path

import numpy as np
from documents import Failure, references, require
from instances import check_things
from models import distances
from package import Package
from PIL import Image
from prefab import Prefab
from schema import CLASSES, SHADERS, STRIPPED, check

# How far a start pose may be above the floor or below it, metres.
ON_FLOOR_M = 0.15
# How high above a start pose rock must be all round, metres.
EYES_M = 0.5
# As metallic as a JPEG may make of 0, on the whole, of 255.
NO_METAL = 4

# What the images of each role must be imported as: textureType (1 is a normal map) and sRGBTexture.
ROLES = {"color": (0, 1), "normal": (1, 0), "mask": (0, 0)}


def check_documents(package, asset):
    """Every object is of a known class and has its fields; every reference leads to something."""
    numbers = {document.file_id: document for document in asset.documents}
    require(len(numbers) == len(asset.documents), f"{asset.name}: two objects have one number")
    for document in asset.documents:
        where = f"{asset.name}: {document.type_name} {document.file_id}"
        known, fields = CLASSES.get(document.class_id, (None, None))
        require(known == document.type_name, f"{where} has the class {document.class_id}, which is {known}")
        check(document.fields, STRIPPED if document.is_stripped else fields, where)
        for reference in references(document.fields):
            check_reference(package, numbers, reference, where)


def check_reference(package, numbers, reference, where):
    file_id, guid = reference["fileID"], str(reference.get("guid"))
    if guid == "None":
        require(file_id == 0 or file_id in numbers, f"{where} names an object that is not there: {file_id}")
    elif guid in SHADERS:
        name, kind, *_ = SHADERS[guid]
        require(kind.items() <= reference.items(), f"{where} names {name} wrongly: {reference}")
    else:
        require(guid in package.assets, f"{where} names an asset that is not there: {guid}")
        asset = package.assets[guid]
        require(asset.has_object(file_id), f"{where} names what {asset.name} has not: {file_id}")
        require(
            reference.get("type") == asset.kind_of_reference, f"{where} has a reference of a wrong type: {reference}"
        )


def check_material(package, asset):
    """The images are in the slots of the shader, and imported as the right kind."""
    (document,) = asset.documents
    fields = document.fields
    require(fields["m_Name"] == asset.path.stem, f"{asset.name} holds a material called {fields['m_Name']}")
    guid = fields["m_Shader"].get("guid")
    require(guid in SHADERS, f"{asset.name} has an unknown shader: {guid}")
    name, _, slots, keywords = SHADERS[guid]
    require(set(fields["m_ValidKeywords"]) == keywords, f"{asset.name}: {name} wants the keywords {sorted(keywords)}")
    textures = {slot: value for entry in fields["m_SavedProperties"]["m_TexEnvs"] for slot, value in entry.items()}
    require(set(textures) == set(slots), f"{asset.name}: {name} wants images in {sorted(slots)}")
    for slot, texture in textures.items():
        check_texture(package.assets[texture["m_Texture"]["guid"]], slots[slot], slot)


def check_texture(asset, role, slot):
    importer = asset.importer
    kind, srgb = ROLES[role]
    require(importer["textureType"] == kind, f"{asset.name} is in {slot} but of textureType {importer['textureType']}")
    require(importer["mipmaps"]["sRGBTexture"] == srgb, f"{asset.name} is in {slot}: sRGBTexture must be {srgb}")
    require(importer["bumpmap"]["flipGreenChannel"] == 0, f"{asset.name} has its green turned round")
    with Image.open(asset.path) as image:
        require(max(image.size) <= importer["maxTextureSize"], f"{asset.name} is larger than its maxTextureSize")
        require(importer["nPOTScale"] == 0, f"{asset.name} would be scaled")
        if role == "mask":
            check_mask(asset.name, image)


def check_mask(name, image):
    """Metalness, occlusion, detail and smoothness: stone is not metallic, and there is no detail map."""
    require(image.mode == "RGBA", f"{name} has no alpha for smoothness")
    pixels = np.asarray(image)
    require(pixels[..., 0].mean() < NO_METAL, f"{name} says that stone is metal")
    require(not pixels[..., 2].any(), f"{name} has a detail map")
    require(pixels[..., 3].std() > 0, f"{name} is equally smooth everywhere")


def check_model(package, asset):
    """It is imported unscaled, in metres, and its tables list its content."""
    importer, model = asset.importer, asset.model
    meshes, tangents = importer["meshes"], importer["tangentSpace"]
    wanted = {"useFileScale": 1, "useFileUnits": 1, "globalScale": 1, "meshCompression": 0, "swapUVChannels": 0}
    wanted |= {
        "bakeAxisConversion": 0,
        "addColliders": 0,
        "importCameras": 0,
        "importLights": 0,
        "fileIdsGeneration": 2,
    }
    for key, value in wanted.items():
        require(meshes[key] == value, f"{asset.name} is imported with {key} {meshes[key]}, not {value}")
    require(tangents["normalImportMode"] == 0, f"{asset.name} loses its normals")
    require(tangents["tangentImportMode"] in (0, 3), f"{asset.name} has tangents that are not MikkTSpace")
    require(importer["animations"]["isReadable"] == 1, f"{asset.name} cannot be read at run time")
    table = {entry["first"].get(43): entry["second"] for entry in importer["internalIDToNameTable"]}
    there = {number: mesh.name for number, mesh in model.meshes.items()}
    require(
        table == there, f"{asset.name} names meshes that are not in it: {sorted(table.items() ^ there.items())[:2]}"
    )
    for entry in importer["externalObjects"]:
        name, reference = entry["first"]["name"], entry["second"]
        require(name in model.materials, f"{asset.name} has no material called {name}")
        check_reference(package, {}, reference, asset.name)


def check_levels(package, prefab):
    """Levels get coarser and are shown ever further away; gives the triangles of the finest."""
    triangles = 0
    for group in prefab.all("LODGroup"):
        heights = [level["screenRelativeHeight"] for level in group.fields["m_LODs"]]
        falls = all(a > b for a, b in zip(heights, heights[1:], strict=False))
        require(falls and heights[-1] >= 0 and heights[0] <= 1, f"{prefab.name}: levels change at {heights}")
        counts = [
            sum(count_seen(package, prefab, entry) for entry in level["renderers"]) for level in group.fields["m_LODs"]
        ]
        require(counts == sorted(counts, reverse=True), f"{prefab.name}: levels have {counts} triangles")
        triangles += counts[0]
    return triangles


def count_seen(package, prefab, entry):
    renderer = prefab.by_number[entry["renderer"]["fileID"]]
    require(renderer.type_name == "MeshRenderer", f"{prefab.name}: a level of detail is a {renderer.type_name}")
    owner = prefab.components[renderer.fields["m_GameObject"]["fileID"]]
    meshes = [prefab.mesh(package, part) for part in owner if part.type_name == "MeshFilter"]
    require(len(meshes) == 1 and meshes[0].is_seen, f"{prefab.name}: a renderer without a mesh that can be seen")
    return len(meshes[0].faces)


def rock_of(package, prefab):
    """Points and triangles of all colliders."""
    points, faces, count = [], [], 0
    for collider in prefab.all("MeshCollider"):
        mesh = prefab.mesh(package, collider)
        require(not mesh.is_seen, f"{prefab.name}: {mesh.name} is touched, but made to be seen")
        points.append(mesh.points)
        faces.append(mesh.faces + count)
        count += len(mesh.points)
    require(points, f"{prefab.name}: nothing to touch")
    return np.concatenate(points), np.concatenate(faces)


def check_place(rock, name, place):
    """Rock is all round a place."""
    for axis in range(3):
        for sign in (-1, 1):
            require(
                len(distances(*rock, place, axis, sign)),
                f"{name} is not in the cave: no rock along {sign:+d} {'xyz'[axis]}",
            )


def check_poses(rock, prefab):
    """Start poses are on the floor and upright, and lights in the cave."""
    spawns = 0
    for name, transform, others in prefab.game_objects():
        place = prefab.position(transform)
        if name.startswith("spawn_"):
            above = place + [0, EYES_M, 0]
            check_place(rock, name, above)
            height = distances(*rock, above, 1, -1).min() - EYES_M
            require(abs(height) < ON_FLOOR_M, f"{name} is {height:.2f} m above the floor")
            check_upright(name, transform)
            spawns += 1
        elif any(part.type_name == "Light" for part in others):
            check_place(rock, name, place)
    require(spawns, f"{prefab.name} has no start pose")
    return spawns


def check_upright(name, transform):
    x, y, z, w = (transform.fields["m_LocalRotation"][part] for part in "xyzw")
    require(abs(x * x + y * y + z * z + w * w - 1) < 1e-4, f"{name} has a rotation that is none")
    up = 1 - 2 * (x * x + z * z)
    require(up > 0.5, f"{name} does not stand: its +Y is not up")


def verify(folder):
    package = Package(folder)
    for asset in package.assets.values():
        if asset.path.suffix in (".mat", ".prefab", ".physicMaterial"):
            check_documents(package, asset)
    for asset in package.of(".mat"):
        check_material(package, asset)
    for asset in package.of(".fbx"):
        check_model(package, asset)
    prefabs = [asset for asset in package.of(".prefab") if asset.path.parent.name == "Runtime"]
    require(len(prefabs) == 1, f"expected one prefab, found {len(prefabs)}")
    prefab = Prefab(prefabs[0])
    triangles = {asset.guid: check_levels(package, Prefab(asset)) for asset in package.of(".prefab")}
    things = check_things(package, prefab)
    seen = triangles[prefabs[0].guid] + sum(triangles[thing.source.guid] for thing in things)
    wanted = sum(chunk["triangles"] for chunk in json.loads((folder / "manifest.json").read_text())["chunks"])
    require(seen == wanted, f"{prefab.name} shows {seen} triangles, and the manifest lists {wanted}")
    rock = rock_of(package, prefab)
    spawns = check_poses(rock, prefab)
    objects = sum(len(asset.documents) for asset in package.assets.values() if asset.path.suffix in (".mat", ".prefab"))
    return f"{len(package.assets)} assets, {objects} objects, {seen} triangles to see and {len(rock[1])} of rock to touch, {len(things)} things, {spawns} start poses"


if __name__ == "__main__":
    try:
        print(verify(Path(sys.argv[1])))
    except Failure as failure:
        sys.exit(f"error: {failure}")

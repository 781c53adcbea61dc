"""Things: instances of prefabs within the prefab of a cave, and `instances.json`, which lists them."""

import json
from dataclasses import dataclass

import numpy as np
from documents import require
from package import WHOLE_PREFAB, Asset
from prefab import Prefab

# How far a thing may be from its place, metres, and how much its axes and its mass may differ.
PLACE_M = 1e-5
AXES = 1e-5
ROUNDED = 1e-6  # numbers have six decimals
MASS = 1e-3
# By its faces, Unity refuses a convex collider that has more.
MOST_FACES = 255
# From the frame of the scene, which is right-handed and Z up, to Unity's.
UNITY_FROM_SCENE = np.array([[-1, 0, 0], [0, 0, 1], [0, -1, 0]], dtype=float)


@dataclass
class Thing:
    """An instance: the prefab that it is one of, and what it has otherwise, by property and by the object it belongs to."""

    source: Asset
    changes: dict

    def of(self, property_path):
        """The value of a property; one object has it."""
        (value,) = self.changes[property_path].values()
        return value

    def vector(self, name, axes):
        return np.array([self.of(f"{name}.{axis}") for axis in axes], dtype=float)


def instances(package, prefab):
    """Those of a prefab, by name."""
    found, family = {}, Family(prefab)
    for document in prefab.all("PrefabInstance"):
        whole = document.fields["m_SourcePrefab"]
        require(whole["fileID"] == WHOLE_PREFAB, f"{prefab.name}: an instance is not of a whole prefab: {whole}")
        source = package.assets[whole["guid"]]
        changes = {}
        for change in document.fields["m_Modification"]["m_Modifications"]:
            target = change["target"]
            require(target.get("guid") == whole["guid"], f"{prefab.name}: an instance changes another prefab: {target}")
            changes.setdefault(change["propertyPath"], {})[target["fileID"]] = change["value"]
        thing = Thing(source, changes)
        family.check(document, source)
        require(thing.of("m_Name") not in found, f"{prefab.name}: two things are called {thing.of('m_Name')}")
        found[thing.of("m_Name")] = thing
    return found


class Family:
    """The transforms of the instances in a prefab, and those of their fathers."""

    def __init__(self, prefab):
        self.name, self.own, self.children = prefab.name, {}, {}
        for transform in prefab.all("Transform"):
            if transform.is_stripped:
                self.own.setdefault(transform.fields["m_PrefabInstance"]["fileID"], []).append(transform)
            else:
                self.children[transform.file_id] = {child["fileID"] for child in transform.fields["m_Children"]}

    def check(self, document, source):
        """The father of an instance lists its transform, which is that of the root of its prefab."""
        (own,) = self.own[document.file_id]
        father = document.fields["m_Modification"]["m_TransformParent"]["fileID"]
        require(own.file_id in self.children[father], f"{self.name}: an instance is no child of its father")
        root = root_of(source)
        require(own.fields["m_CorrespondingSourceObject"]["fileID"] == root.file_id, f"{source.name} has another root")
        # As in the prefabs that Unity writes.
        number = document.file_id ^ root.file_id
        require(
            own.file_id == number, f"{self.name}: an object of an instance has the number {own.file_id}, not {number}"
        )


def root_of(source):
    """The transform of the root of a prefab."""
    (root,) = [one for one in source.documents if one.type_name == "Transform" and not one.fields["m_Father"]["fileID"]]
    return root


def check_things(package, prefab):
    """Every thing of `instances.json` is an instance at its place, and nothing else is; gives the instances."""
    path = package.folder / "instances.json"
    listed = json.loads(path.read_text())["things"] if path.is_file() else []
    found = instances(package, prefab)
    names = {f"{thing['class']}_{thing['id']}" for thing in listed}
    require(set(found) == names, f"{prefab.name} has {len(found)} things, and instances.json lists {len(names)}")
    for thing in listed:
        check_thing(package, f"{thing['class']}_{thing['id']}", thing, found[f"{thing['class']}_{thing['id']}"])
    return list(found.values())


def check_thing(package, name, listed, thing):
    place = UNITY_FROM_SCENE @ np.array(listed["position"])
    off_m = np.abs(thing.vector("m_LocalPosition", "xyz") - place).max()
    require(off_m < PLACE_M, f"{name} is {off_m:.3f} m away from its place")
    # An axis of the prototype, where the scene has it and where Unity turns it.
    w, x, y, z = listed["orientation_wxyz"]
    expected = UNITY_FROM_SCENE @ matrix(x, y, z, w) @ UNITY_FROM_SCENE.T
    turned = matrix(*thing.vector("m_LocalRotation", "xyzw"))
    require(np.abs(turned - expected).max() < AXES, f"{name} is turned otherwise than in the scene")
    scale = thing.vector("m_LocalScale", "xyz")
    require(
        np.abs(scale - listed["scale"]).max() < max(AXES * listed["scale"], ROUNDED), f"{name} has the scale {scale}"
    )
    require(thing.source.name.startswith(f"{listed['prototype']}_level"), f"{name} is a {thing.source.name}")
    check_body(name, listed, thing)
    check_collider(package, name, thing.source)


def check_body(name, listed, thing):
    """What is movable has a body of its mass."""
    bodies = [one for one in thing.source.documents if one.type_name == "Rigidbody"]
    require(
        len(bodies) == int(listed["movable"]), f"{name} has {len(bodies)} bodies, and movable is {listed['movable']}"
    )
    for body in bodies:
        require(body.fields["m_IsKinematic"] == 0 and body.fields["m_UseGravity"] == 1, f"{name} does not fall")
        mass = thing.changes["m_Mass"].get(body.file_id)
        require(mass and abs(mass / listed["mass_kg"] - 1) < MASS, f"{name} has {mass} kg, not {listed['mass_kg']}")
    root = Prefab(thing.source).by_number[root_of(thing.source).fields["m_GameObject"]["fileID"]]
    require(bool(root.fields["m_StaticEditorFlags"]) != bool(bodies), f"{name} is static and moves, or neither")


def check_collider(package, name, source):
    prefab = Prefab(source)
    colliders = prefab.all("MeshCollider")
    require(len(colliders) == 1 and colliders[0].fields["m_Convex"] == 1, f"{name} has no convex collider of its own")
    mesh = prefab.mesh(package, colliders[0])
    require(len(mesh.faces) <= MOST_FACES, f"{name} has a collider of {len(mesh.faces)} faces")
    require(len(prefab.all("LODGroup")) == 1, f"{name} has no levels of detail")


def matrix(x, y, z, w):
    """The rotation of a unit quaternion; what it does to axes is the same in frames of either hand."""
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )

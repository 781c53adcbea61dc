"""The objects of a prefab: who belongs to whom, and where."""

import numpy as np
from documents import require


class Prefab:
    """Game objects with their components, which agree on who belongs to whom."""

    def __init__(self, asset):
        self.name = asset.name
        self.by_number = {document.file_id: document for document in asset.documents}
        self.by_type = {}
        for document in self.by_number.values():
            self.by_type.setdefault(document.type_name, []).append(document)
        self.components = {}
        for document in asset.documents:
            if document.type_name == "GameObject":
                self.components[document.file_id] = self.components_of(document)
            elif document.type_name == "Transform" and not document.is_stripped:
                self.check_family(document)
        owned = sum(len(components) for components in self.components.values())
        own = [one for one in asset.documents if not one.is_stripped and one.type_name != "PrefabInstance"]
        require(owned + len(self.components) == len(own), f"{self.name}: a component belongs to no game object")

    def components_of(self, document):
        found = [self.by_number[entry["component"]["fileID"]] for entry in document.fields["m_Component"]]
        require(found and found[0].type_name == "Transform", f"{self.name}: a game object begins without a transform")
        for component in found:
            owner = component.fields["m_GameObject"]["fileID"]
            require(owner == document.file_id, f"{self.name}: {component.type_name} belongs to another game object")
        return found

    def check_family(self, document):
        for child in document.fields["m_Children"]:
            child = self.by_number[child["fileID"]]
            if child.is_stripped:
                child = self.by_number[child.fields["m_PrefabInstance"]["fileID"]]
                father = child.fields["m_Modification"]["m_TransformParent"]["fileID"]
            else:
                father = child.fields["m_Father"]["fileID"]
            require(father == document.file_id, f"{self.name}: a child has another father")

    def game_objects(self):
        """Name, transform and the other components by class, of each."""
        for number, (transform, *others) in self.components.items():
            yield self.by_number[number].fields["m_Name"], transform, others

    def all(self, type_name):
        return self.by_type.get(type_name, [])

    def mesh(self, package, document):
        reference = document.fields["m_Mesh"]
        return package.assets[reference["guid"]].model.meshes[reference["fileID"]]

    def position(self, transform):
        """In the prefab; nothing above is turned or scaled."""
        place = np.array([transform.fields["m_LocalPosition"][axis] for axis in "xyz"], dtype=float)
        father = transform.fields["m_Father"]["fileID"]
        return place if father == 0 else place + self.position(self.by_number[father])

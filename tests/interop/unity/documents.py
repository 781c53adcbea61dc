"""Unity's YAML, read by PyYAML: documents with the tags `!u!<class>` and the anchors that other documents name.

https://docs.unity3d.com/Manual/FormatDescription.html
"""

import re
from dataclasses import dataclass

import yaml


class Failure(Exception):
    """What is wrong with a package."""


def require(truth, message):
    if not truth:
        raise Failure(message)


@dataclass
class Document:
    """An object: the number of its class, its own number in the file, the name of its class, and its fields.

    A stripped one stands for an object of a nested prefab, and has few fields.
    """

    class_id: int
    file_id: int
    type_name: str
    fields: dict
    is_stripped: bool = False


class UnityLoader(yaml.SafeLoader):
    """Knows the tag of all documents, which Unity declares at the first one only, and keeps the anchor of each."""

    DEFAULT_TAGS = {**yaml.SafeLoader.DEFAULT_TAGS, "!u!": "tag:unity3d.com,2011:"}

    def compose_mapping_node(self, anchor):
        node = super().compose_mapping_node(anchor)
        node.anchor_text = anchor
        return node


def construct_document(loader, class_id, node):
    content = loader.construct_mapping(node, deep=True)
    require(len(content) == 1, f"a document of class {class_id} has {len(content)} types")
    ((type_name, fields),) = content.items()
    return Document(int(class_id), int(node.anchor_text), type_name, fields)


UnityLoader.add_multi_constructor("tag:unity3d.com,2011:", construct_document)


STRIPPED = r"^(--- !u!\d+ &(-?\d+)) stripped$"


def read_documents(path):
    """All objects of an asset."""
    text = path.read_text()
    require(
        text.startswith("%YAML 1.1\n%TAG !u! tag:unity3d.com,2011:\n"), f"{path.name} does not begin as Unity's YAML"
    )
    try:
        # To YAML, the word that Unity puts behind the anchor is no part of a mapping.
        documents = list(yaml.load_all(re.sub(STRIPPED, r"\1", text, flags=re.MULTILINE), UnityLoader))
    except (yaml.YAMLError, ValueError) as error:
        raise Failure(f"{path.name} is no YAML of Unity: {error}") from error
    require(all(isinstance(one, Document) for one in documents), f"{path.name} has a document without a class")
    stripped = {int(number) for _, number in re.findall(STRIPPED, text, flags=re.MULTILINE)}
    for document in documents:
        document.is_stripped = document.file_id in stripped
    return documents


def read_meta(path):
    """A `.meta`, which has neither tags nor several documents."""
    try:
        return yaml.safe_load(path.read_text())
    except yaml.YAMLError as error:
        raise Failure(f"{path.name} is no YAML: {error}") from error


def references(value):
    """Every `{fileID: …}` in a value, however deep."""
    if isinstance(value, dict):
        if "fileID" in value:
            yield value
        else:
            for part in value.values():
                yield from references(part)
    elif isinstance(value, list):
        for part in value:
            yield from references(part)

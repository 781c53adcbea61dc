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


class UnityLoader(yaml.CSafeLoader):
    """Knows the tags of objects."""


def construct_object(loader, class_id, node):
    content = loader.construct_mapping(node, deep=True)
    require(len(content) == 1, f"a document of class {class_id} has {len(content)} types")
    ((type_name, fields),) = content.items()
    return int(class_id), type_name, fields


TAG = "tag:unity3d.com,2011:"
UnityLoader.add_multi_constructor(TAG, construct_object)

# Class and number of an object. To YAML, the word that Unity puts behind the anchor is no part of a mapping.
HEADER = re.compile(r"^--- !u!(\d+) &(-?\d+)( stripped)?$", re.MULTILINE)


def read_documents(path):
    """All objects of an asset."""
    text = path.read_text()
    require(text.startswith(f"%YAML 1.1\n%TAG !u! {TAG}\n"), f"{path.name} does not begin as Unity's YAML")
    # Unity declares the tag at the first document only, so it is written out at each.
    spelled = HEADER.sub(rf"--- !<{TAG}\1> &\2", text)
    try:
        objects = list(yaml.load_all(spelled, UnityLoader))
    except (yaml.YAMLError, ValueError) as error:
        raise Failure(f"{path.name} is no YAML of Unity: {error}") from error
    heads = HEADER.findall(text)
    require(
        len(objects) == len(heads) and all(isinstance(one, tuple) for one in objects),
        f"{path.name} has a document without a class",
    )
    return [
        Document(class_id, int(file_id), type_name, fields, bool(stripped))
        for (class_id, type_name, fields), (_, file_id, stripped) in zip(objects, heads, strict=True)
    ]


def read_meta(path):
    """A `.meta`, which has neither tags nor several documents."""
    try:
        return yaml.load(path.read_text(), yaml.CSafeLoader)
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

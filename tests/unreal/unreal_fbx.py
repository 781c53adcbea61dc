"""The little that the stub of an importer has to know of our FBX files; foreign readers judge them elsewhere."""

import re
import struct
import zlib
from pathlib import Path


class Fbx:
    """Names of the nodes with meshes, the unit, the front axis and the vertices of the first mesh."""

    def __init__(self, path: Path):
        data = path.read_bytes()
        self.nodes = [name.decode() for name in re.findall(rb"([\w]+)\0\x01ModelS\x04\0\0\0Mesh", data)]
        self.unit_cm = _setting(data, b"UnitScaleFactor", b"double", b"Number", b"D", "<d")
        front = [_setting(data, name, b"int", b"Integer", b"I", "<i") for name in (b"FrontAxis", b"FrontAxisSign")]
        self.front_is_minus_y = front == [1, -1]
        self.vertices = _vertices(data)


def _setting(data: bytes, name: bytes, kind: bytes, label: bytes, code: bytes, layout: str) -> float:
    words = b"".join(b"S" + struct.pack("<I", len(word)) + word for word in (name, kind, label, b""))
    at = data.index(words + code) + len(words) + 1
    return struct.unpack_from(layout, data, at)[0]


def _vertices(data: bytes) -> list[tuple[float, float, float]]:
    at = data.index(b"\x08Verticesd") + len(b"\x08Verticesd")
    count, packed, length = struct.unpack_from("<III", data, at)
    numbers = data[at + 12 : at + 12 + length]
    return list(struct.iter_unpack("<ddd", zlib.decompress(numbers) if packed else numbers))[: count // 3]

"""The triangles of a package of target `ply` without gravel, what each belongs to, and what libigl says of points among them."""

import json

import igl
import numpy as np
import plyfile
from failure import require

GRAVEL = "gravel"


class World:
    def __init__(self, package):
        [path] = package.glob("*.ply")
        data = plyfile.PlyData.read(path)
        comments = [comment.split() for comment in data.comments if comment.startswith("label ")]
        self.names = {int(label): name for _, label, name in comments}
        require(self.names, "the PLY has no labels")
        vertex, face = data["vertex"], data["face"].data
        self.vertices = np.stack([vertex[axis] for axis in "xyz"], axis=1).astype(np.float64)
        is_solid = np.array([self.names[label] != GRAVEL for label in range(1, max(self.names) + 1)])[face["label"] - 1]
        self.faces = np.stack(face["vertex_indices"][is_solid]).astype(np.int64)
        self.labels = face["label"][is_solid]
        chunks = json.loads((package / "manifest.json").read_text(encoding="utf-8"))["chunks"]
        self.chunk_names = [chunk["name"] for chunk in chunks]
        self.chunks = np.repeat(np.arange(len(chunks)), [chunk["triangles"] for chunk in chunks])[is_solid]
        things = package / "instances.json"
        self.things = json.loads(things.read_text(encoding="utf-8"))["things"] if things.exists() else []
        across = np.cross(*(self.vertices[self.faces[:, n]] - self.vertices[self.faces[:, 0]] for n in (1, 2)))
        doubled = np.linalg.norm(across, axis=1)
        self.areas = doubled / 2
        self.normals = across / np.maximum(doubled, 1e-300)[:, None]

    def nearest(self, points):
        """Distance from points to the nearest triangle, which one that is, and the nearest point on it."""
        squares, faces, nearest = igl.point_mesh_squared_distance(points, self.vertices, self.faces)[:3]
        return np.sqrt(squares), np.asarray(faces).ravel(), nearest

    def is_air(self, points):
        """The wall winds once around air, inside out, and things make up for it: see Jacobson, Kavan and Sorkine-Hornung 2013."""
        return igl.fast_winding_number(self.vertices, self.faces, points) < -0.5

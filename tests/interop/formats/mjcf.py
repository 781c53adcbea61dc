"""MJCF, as MuJoCo has compiled it.

The compiler moves each mesh to its own centre and axes, and each geom there.
"""

import mujoco
import numpy as np
from packages import Reader, Triangles, joined, upper_left

VISUAL = 2  # the group of geoms that are drawn


def by_mujoco(path):
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    geoms = [geom for geom in range(model.ngeom) if model.geom_group[geom] == VISUAL]
    return joined(triangles(model, data, geom) for geom in geoms)


def triangles(model, data, geom):
    mesh = model.geom_dataid[geom]
    turn, place = data.geom_xmat[geom].reshape(3, 3), data.geom_xpos[geom]

    def rows(of, numbers, start):
        return of[start[mesh] : start[mesh] + numbers[mesh]]

    points = rows(model.mesh_vert, model.mesh_vertnum, model.mesh_vertadr) @ turn.T + place
    normals = rows(model.mesh_normal, model.mesh_normalnum, model.mesh_normaladr) @ turn.T
    uv = upper_left(rows(model.mesh_texcoord, model.mesh_texcoordnum, model.mesh_texcoordadr))
    corners = [rows(of, model.mesh_facenum, model.mesh_faceadr)
               for of in (model.mesh_face, model.mesh_facenormal, model.mesh_facetexcoord)]  # fmt: skip
    values = [rows.astype(np.float64)[faces] for rows, faces in zip((points, normals, uv), corners, strict=True)]
    return Triangles(*values)


READERS = [Reader("MuJoCo", by_mujoco, {"mujoco": ["marker.xml"]})]

//! Splits non-manifold vertices, in which two parts of a mesh touch.
//!
//! A surface may be manifold while a part of it is not: where the border of the part touches itself in a point, two fans of
//! triangles share a vertex. Readers that require each mesh to be manifold need a vertex for each.

use crate::scene::Mesh;

/// Gives every fan of a vertex except the first a copy of it, appended to the vertices. Positions and triangles only.
pub(crate) fn split_nonmanifold_vertices(mesh: &mut Mesh) {
    let mut corners: Vec<usize> = (0..mesh.indices.len()).collect();
    corners.sort_by_key(|&corner| mesh.indices[corner]);
    let mut moves = Vec::new();
    for around in corners.chunk_by(|&a, &b| mesh.indices[a] == mesh.indices[b]) {
        for fan in fans(&mesh.indices, around).split_off(1) {
            moves.push(fan);
        }
    }
    for fan in moves {
        let copy = mesh.positions.len() as u32;
        mesh.positions.push(mesh.positions[mesh.indices[fan[0]] as usize]);
        for corner in fan {
            mesh.indices[corner] = copy;
        }
    }
}

/// The corners at one vertex, by fan: those whose triangles share an edge at the vertex, directly or through others.
fn fans(indices: &[u32], around: &[usize]) -> Vec<Vec<usize>> {
    let mut rest = around.to_vec();
    let mut fans = Vec::new();
    while let Some(first) = (!rest.is_empty()).then(|| rest.remove(0)) {
        let mut fan = vec![first];
        let mut reached = 0;
        while reached < fan.len() {
            let ends = others(indices, fan[reached]);
            let touches = |corner: &mut usize| others(indices, *corner).iter().any(|end| ends.contains(end));
            fan.extend(rest.extract_if(.., touches));
            reached += 1;
        }
        fans.push(fan);
    }
    fans
}

/// The other two vertices of the triangle of a corner.
fn others(indices: &[u32], corner: usize) -> [u32; 2] {
    let first = corner / 3 * 3;
    [first + (corner + 1) % 3, first + (corner + 2) % 3].map(|other| indices[other])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(vertices: usize, indices: &[u32]) -> Mesh {
        let positions = (0..vertices).map(|x| [x as f32, 0.0, 0.0]).collect();
        Mesh { positions, indices: indices.to_vec(), ..Mesh::default() }
    }

    #[test]
    fn two_fans_get_a_vertex_each() {
        let mut touching = mesh(5, &[0, 1, 2, 0, 3, 4]);
        split_nonmanifold_vertices(&mut touching);
        assert_eq!(touching.indices, [0, 1, 2, 5, 3, 4]);
        assert_eq!(touching.positions[5], touching.positions[0]);
    }

    #[test]
    fn one_fan_stays_as_it_is() {
        let open = mesh(5, &[0, 3, 4, 0, 1, 2, 0, 2, 3]);
        let closed = mesh(4, &[0, 2, 3, 0, 1, 2, 0, 3, 1]);
        for mut whole in [open, closed] {
            let before = whole.clone();
            split_nonmanifold_vertices(&mut whole);
            assert_eq!(whole, before);
        }
    }
}

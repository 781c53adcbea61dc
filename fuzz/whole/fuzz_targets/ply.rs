//! A mesh that is read names no vertex that is not there.
#![no_main]

use plume::store::ply::PlyMesh;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(mesh) = PlyMesh::read(&mut &*bytes) else { return };
    assert!(mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < mesh.positions.len()));
    for count in [mesh.normals.len(), mesh.uvs.len(), mesh.tangents.len(), mesh.border.len()] {
        assert!(count == 0 || count == mesh.positions.len());
    }
});

//! Collapses edges in the order of cost, under the link condition (Dey et al., *Topology preserving edge contraction*,
//! 1999), so a manifold stays one and keeps its genus.
//!
//! A [`CollapsePolicy`] determines which edges may collapse, and where to. In any case border vertices stay where they are,
//! no new edge joins two of them (two chunks could both add it), and no triangle flips or becomes a needle.

use super::collapse_mesh::{Collapse, CollapseMesh};
use super::queue::{Edge, Queue};
use super::{Mesh, QUANTA_PER_M};

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StopCriterion {
    /// Collapse while the error stays below this, in metres; 0 collapses nothing.
    pub(crate) error_m: f32,
    /// Then continue, whatever the error, while there are more triangles than this.
    pub(crate) most_triangles: Option<usize>,
}

impl StopCriterion {
    /// Squared error in quanta.
    fn most_error(self) -> f64 {
        let quanta = f64::from(self.error_m) * f64::from(QUANTA_PER_M);
        quanta * quanta
    }

    /// Square of the largest error worth considering, in quanta.
    fn limit(self) -> f64 {
        if self.most_triangles.is_some() { f64::INFINITY } else { self.most_error() }
    }

    fn is_over_budget(self, triangles: usize) -> bool {
        self.most_triangles.is_some_and(|most| triangles > most)
    }

    fn is_reached(self, triangles: usize) -> bool {
        self.error_m == 0.0 && !self.is_over_budget(triangles)
    }
}

/// Which edges may collapse.
pub(crate) trait CollapsePolicy {
    /// The possible collapses of an edge, each planned separately.
    fn ways(ends: [u32; 2]) -> impl Iterator<Item = [u32; 2]>;

    /// The collapse of an edge, if possible.
    fn plan(&self, collapse_mesh: &CollapseMesh, ends: [u32; 2]) -> Option<Collapse>;

    /// Whether a collapse that preserves topology and shape is allowed.
    fn allows(&self, collapse_mesh: &CollapseMesh, collapse: &Collapse) -> bool;

    /// Called before a collapse.
    fn apply(&mut self, collapse_mesh: &CollapseMesh, collapse: &Collapse);
}

/// Share of an edge's squared length in its cost, so that short edges of flat patches go first. Tuned.
const LENGTH_SHARE: f64 = 1e-6;

/// Collapses a mesh with a policy, towards one goal after the other.
pub(crate) struct Collapser<'a, R> {
    pub(crate) mesh: CollapseMesh<'a>,
    pub(crate) rule: R,
    /// Counts changes around a vertex; older candidates are stale.
    versions: Vec<u32>,
    queue: Queue,
    marks: Marks,
    ring: Vec<u32>,
}

impl<'a, R: CollapsePolicy> Collapser<'a, R> {
    pub(crate) fn new(mesh: &'a Mesh, rule: R) -> Self {
        Self {
            mesh: CollapseMesh::new(mesh),
            rule,
            versions: vec![0; mesh.positions.len()],
            queue: Queue::new(),
            marks: Marks::new(mesh.positions.len()),
            ring: Vec::new(),
        }
    }

    /// Collapses to the goal; returns the maximum error in metres.
    pub(crate) fn run(&mut self, goal: StopCriterion) -> f32 {
        self.queue = Queue::new();
        self.queue_all(goal.limit());
        let mut greatest = 0.0f64;
        while !goal.is_reached(self.mesh.live())
            && let Some(edge) = self.queue.pop()
        {
            let plan = self.is_current(edge).then(|| self.rule.plan(&self.mesh, edge.ends)).flatten();
            let Some(collapse) = plan else { continue };
            let worth = collapse.error < goal.most_error() || goal.is_over_budget(self.mesh.live());
            if !worth || !self.is_lawful(&collapse) {
                continue;
            }
            greatest = greatest.max(collapse.error);
            self.rule.apply(&self.mesh, &collapse);
            self.mesh.apply(&collapse);
            self.queue_around(collapse.kept, goal.limit());
        }
        (greatest.sqrt() / f64::from(QUANTA_PER_M)) as f32
    }

    fn queue_all(&mut self, limit: f64) {
        for index in 0..self.mesh.triangles.len() {
            let [a, b, c] = self.mesh.triangles[index];
            for ends in [[a, b], [b, c], [c, a]] {
                // An inner edge is offered by the triangles on both sides: one is enough. Edges without a second triangle
                // join two border vertices and are not candidates.
                if ends[0] < ends[1] {
                    self.queue_edge(ends, limit);
                }
            }
        }
    }

    fn queue_around(&mut self, vertex: u32, limit: f64) {
        self.versions[vertex as usize] += 1;
        self.marks.clear();
        for corner in self.mesh.corners.of(vertex) {
            for end in others(self.mesh.triangles[corner.triangle], vertex) {
                if self.marks.set(end) {
                    self.ring.push(end);
                }
            }
        }
        while let Some(end) = self.ring.pop() {
            self.queue_edge([vertex, end], limit);
        }
    }

    fn queue_edge(&mut self, ends: [u32; 2], limit: f64) {
        for ends in R::ways(ends) {
            let plan = self.rule.plan(&self.mesh, ends);
            let Some(collapse) = plan.filter(|collapse| collapse.error < limit) else { continue };
            let [a, b] = ends.map(|end| self.mesh.position(end));
            let cost = collapse.error + LENGTH_SHARE * (a - b).norm_squared();
            self.queue.push(cost as f32, Edge { ends, version: self.version(ends) });
        }
    }

    /// Versions only grow, so an equal sum means that neither vertex changed.
    fn version(&self, ends: [u32; 2]) -> u32 {
        ends.map(|end| self.versions[end as usize]).iter().sum()
    }

    fn is_current(&self, edge: Edge) -> bool {
        edge.ends.iter().all(|&end| self.mesh.is_alive(end)) && self.version(edge.ends) == edge.version
    }

    fn is_lawful(&mut self, collapse: &Collapse) -> bool {
        let collapse_mesh = &self.mesh;
        let stays = |vertex| collapse_mesh.position(vertex) == collapse.to;
        keeps_topology(collapse_mesh, &mut self.marks, [collapse.kept, collapse.gone])
            && collapse_mesh.keeps_form(collapse.gone, collapse)
            && (stays(collapse.kept) || collapse_mesh.keeps_form(collapse.kept, collapse))
            && self.rule.allows(collapse_mesh, collapse)
    }
}

/// The link condition and the rule against chords of the border.
fn keeps_topology(collapse_mesh: &CollapseMesh, marks: &mut Marks, [kept, gone]: [u32; 2]) -> bool {
    marks.clear();
    for corner in collapse_mesh.corners.of(kept) {
        for end in others(collapse_mesh.triangles[corner.triangle], kept) {
            marks.set(end);
        }
    }
    let mut shared = 0;
    // `gone` is an inner vertex: walking around it meets each neighbour once as the next corner.
    for corner in collapse_mesh.corners.of(gone) {
        let end = collapse_mesh.triangles[corner.triangle][(corner.place + 1) % 3];
        if marks.has(end) {
            let least = if collapse_mesh.is_border(end) { 2 } else { 4 };
            if collapse_mesh.corners.of(end).take(least).count() < least {
                return false;
            }
            shared += 1;
        } else if end != kept && collapse_mesh.is_border(kept) && collapse_mesh.is_border(end) {
            return false;
        }
    }
    shared == 2
}

fn others(triangle: [u32; 3], vertex: u32) -> impl Iterator<Item = u32> {
    triangle.into_iter().filter(move |&corner| corner != vertex)
}

/// A set of vertices that is cleared in constant time.
struct Marks {
    rounds: Vec<u32>,
    round: u32,
}

impl Marks {
    fn new(vertices: usize) -> Self {
        Self { rounds: vec![0; vertices], round: 0 }
    }

    fn clear(&mut self) {
        self.round += 1;
    }

    /// Whether it is new.
    fn set(&mut self, vertex: u32) -> bool {
        std::mem::replace(&mut self.rounds[vertex as usize], self.round) != self.round
    }

    fn has(&self, vertex: u32) -> bool {
        self.rounds[vertex as usize] == self.round
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(positions: Vec<[i32; 3]>, triangles: Vec<[u32; 3]>, border: Vec<bool>) -> Mesh {
        Mesh { positions, normals: Vec::new(), triangles, border }
    }

    fn keeps_topology(mesh: &Mesh, kept: u32, gone: u32) -> bool {
        super::keeps_topology(&CollapseMesh::new(mesh), &mut Marks::new(mesh.positions.len()), [kept, gone])
    }

    /// A ring of `around` triangular sections: edges of a section have a third common neighbour.
    fn ring(around: u32) -> Mesh {
        let vertex = |section: u32, corner: u32| section % around * 3 + corner % 3;
        let positions = (0..around * 3).map(|v| [v as i32, (v * v) as i32, (v % 3) as i32]);
        let sides = (0..around).flat_map(|section| (0..3).map(move |corner| (section, corner)));
        let triangles = sides.flat_map(|(s, c)| {
            let [a, b] = [vertex(s, c), vertex(s, c + 1)];
            let [d, e] = [vertex(s + 1, c), vertex(s + 1, c + 1)];
            [[a, b, e], [a, e, d]]
        });
        let border = vec![false; 3 * around as usize];
        mesh(positions.collect(), triangles.collect(), border)
    }

    #[test]
    fn a_ring_is_never_pinched() {
        let ring = ring(8);
        assert!(!keeps_topology(&ring, 0, 1), "the section would become an edge");
        assert!(keeps_topology(&ring, 0, 3), "along the ring there is room");
    }

    #[test]
    fn a_tetrahedron_stays() {
        let faces = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        let corners = vec![[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]];
        assert!(!keeps_topology(&mesh(corners, faces, vec![false; 4]), 0, 1));
    }

    #[test]
    fn no_chord_joins_two_border_vertices() {
        // A fan of six around vertex 0; the six are the border.
        let rim = [[9, 0, 0], [5, 8, 0], [-5, 8, 0], [-9, 0, 0], [-5, -8, 0], [5, -8, 0]];
        let positions: Vec<_> = std::iter::once([0; 3]).chain(rim).collect();
        let faces: Vec<_> = (0..6).map(|k| [0, 1 + k, 1 + (k + 1) % 6]).collect();
        let border: Vec<_> = (0..7).map(|vertex| vertex > 0).collect();
        assert!(!keeps_topology(&mesh(positions, faces, border), 1, 0));
    }
}

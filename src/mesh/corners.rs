use super::Mesh;

const NONE: u32 = u32::MAX;

/// A corner of a triangle.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub(super) triangle: usize,
    /// Which of its three, 0 to 2.
    pub(super) place: usize,
}

impl Corner {
    fn from_link(link: u32) -> Option<Self> {
        let link = link as usize;
        (link != NONE as usize).then_some(Self { triangle: link / 3, place: link % 3 })
    }

    fn link(self) -> usize {
        3 * self.triangle + self.place
    }
}

/// The corners at each vertex, in linked lists over one array.
pub(super) struct Corners {
    first: Vec<u32>,
    next: Vec<u32>,
}

impl Corners {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let first = vec![NONE; mesh.positions.len()];
        let mut corners = Self { first, next: vec![NONE; 3 * mesh.triangles.len()] };
        for (triangle, vertices) in mesh.triangles.iter().enumerate().rev() {
            for (place, &vertex) in vertices.iter().enumerate() {
                corners.insert(vertex, Corner { triangle, place });
            }
        }
        corners
    }

    pub(super) fn of(&self, vertex: u32) -> impl Iterator<Item = Corner> {
        let first = Corner::from_link(self.first[vertex as usize]);
        std::iter::successors(first, |&corner| self.after(corner))
    }

    pub(super) fn after(&self, corner: Corner) -> Option<Corner> {
        Corner::from_link(self.next[corner.link()])
    }

    pub(super) fn is_alive(&self, vertex: u32) -> bool {
        self.first[vertex as usize] != NONE
    }

    pub(super) fn insert(&mut self, vertex: u32, corner: Corner) {
        let first = &mut self.first[vertex as usize];
        self.next[corner.link()] = std::mem::replace(first, corner.link() as u32);
    }

    pub(super) fn remove(&mut self, vertex: u32, corner: Corner) {
        let (link, after) = (corner.link() as u32, self.next[corner.link()]);
        if self.first[vertex as usize] == link {
            self.first[vertex as usize] = after;
            return;
        }
        let is_before = |corner: &Corner| self.next[corner.link()] == link;
        let before = self.of(vertex).find(is_before).expect("it was inserted").link();
        self.next[before] = after;
    }

    /// Removes all corners from a vertex and returns the first of them.
    pub(super) fn detach(&mut self, vertex: u32) -> Option<Corner> {
        Corner::from_link(std::mem::replace(&mut self.first[vertex as usize], NONE))
    }
}

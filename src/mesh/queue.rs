/// Bits of a cost that its class ignores: the exponent and four bits of the mantissa of an `f32` remain.
const LEFT_OUT_BITS: u32 = 19;
const CLASSES: usize = 1 << (31 - LEFT_OUT_BITS);

/// A queue of edges by ascending cost. Costs that differ by less than 6 % form a class, which is sorted once, when all
/// cheaper ones are done; later additions to it go first. So the order depends only on the calls, and unlike a binary heap
/// the queue reads memory sequentially.
pub(super) struct Queue {
    classes: Vec<Vec<Entry>>,
    /// The sorted class; those below are empty.
    current: usize,
}

/// An edge to collapse, as it was when queued.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Edge {
    pub(super) ends: [u32; 2],
    pub(super) version: u32,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Entry {
    cost_bits: u32,
    edge: Edge,
}

impl Queue {
    pub(super) fn new() -> Self {
        Self { classes: vec![Vec::new(); CLASSES], current: CLASSES }
    }

    /// Queues an edge; the cost is not negative.
    pub(super) fn push(&mut self, cost: f32, edge: Edge) {
        let cost_bits = cost.to_bits();
        let class = (cost_bits >> LEFT_OUT_BITS) as usize;
        self.classes[class].push(Entry { cost_bits, edge });
        if class < self.current {
            self.current = class;
        }
    }

    /// The edge of least cost.
    pub(super) fn pop(&mut self) -> Option<Edge> {
        while self.classes.get(self.current)?.is_empty() {
            self.current += 1;
            if let Some(class) = self.classes.get_mut(self.current) {
                class.sort_unstable_by(|a, b| b.cmp(a));
            }
        }
        self.classes[self.current].pop().map(|entry| entry.edge)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_leave_by_cost() {
        let edge = |name| Edge { ends: [name; 2], version: 0 };
        let mut queue = Queue::new();
        for (cost, name) in [(0.0, 1), (5.01, 2), (5.0, 0), (7.0, 3)] {
            queue.push(cost, edge(name));
        }
        assert_eq!(queue.pop(), Some(edge(1)));
        assert_eq!(queue.pop(), Some(edge(0)));
        queue.push(1.0, edge(4));
        let rest: Vec<u32> = std::iter::from_fn(|| queue.pop()).map(|e| e.ends[0]).collect();
        assert_eq!(rest, [4, 2, 3]);
        assert_eq!(queue.pop(), None);
        queue.push(f32::INFINITY, edge(5));
        assert_eq!(queue.pop(), Some(edge(5)));
    }
}

//! Values for the states of a robot, of which a floor has many.

use rustc_hash::FxHashMap;

use super::search::{State, Terrain};

/// A value for each state of the cells that were come to. Keys for states of their own would take more room than values.
pub struct ByState<T> {
    /// Where the values of a cell begin, which are by direction.
    first: FxHashMap<u32, u32>,
    values: Vec<T>,
}

impl<T> Default for ByState<T> {
    fn default() -> Self {
        Self { first: FxHashMap::default(), values: Vec::new() }
    }
}

impl<T: Copy> ByState<T> {
    /// The value of a state; `None` if nothing came to its cell.
    pub fn get(&self, state: State) -> Option<&T> {
        let first = *self.first.get(&state.cell)? as usize;
        Some(&self.values[first + usize::from(state.direction)])
    }

    /// The value of a state. All those of its cell have the value `unset` when something comes there for the first time.
    pub fn entry(&mut self, state: State, terrain: &dyn Terrain, unset: T) -> &mut T {
        let Self { first, values } = self;
        let first = *first.entry(state.cell).or_insert_with(|| {
            let first = values.len();
            values.resize(first + usize::from(terrain.directions(state.cell as usize)), unset);
            first as u32
        });
        &mut values[first as usize + usize::from(state.direction)]
    }
}

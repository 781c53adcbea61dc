//! Random numbers that follow from a cell of the map.

/// Random numbers of a cell (SplitMix64; Steele, Lea and Flood 2014).
#[derive(Clone)]
pub(super) struct Lots {
    id: u64,
    state: u64,
}

impl Lots {
    /// Those of a cell.
    pub fn new(salt: u64, [x, y]: [i32; 2]) -> Self {
        let mut lots = Self { id: 0, state: salt };
        for cell in [x, y] {
            lots.state = lots.next() ^ u64::from(cell as u32);
        }
        lots.id = lots.next();
        lots
    }

    /// The identity of the candidate at this height: a cell of the map has one per storey.
    pub fn id(&self, z: f64) -> u64 {
        Self { state: self.id ^ (storey(z) as u64), ..self.clone() }.next()
    }

    /// The lowest place of each storey, of places from below: two ledges of one storey would have the same identity.
    pub fn one_per_storey<T>(&self, places: impl Iterator<Item = T>, z: impl Fn(&T) -> f64) -> Vec<T> {
        let mut places: Vec<T> = places.collect();
        places.dedup_by_key(|place| storey(z(place)));
        places
    }

    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.state ^ (self.state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Between 0 and 1.
    pub fn unit(&mut self) -> f64 {
        ((self.next() >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    /// Between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// One of these, if there are any.
    pub fn one_of<'a, T>(&mut self, all: &'a [T]) -> Option<&'a T> {
        all.get((self.unit() * all.len() as f64) as usize)
    }

    /// From the standard normal distribution.
    pub fn normal(&mut self) -> f64 {
        plume_graph::rng::probit(self.unit())
    }
}

/// The storey of a height: they are a metre high.
fn storey(z: f64) -> i64 {
    z.floor() as i64
}

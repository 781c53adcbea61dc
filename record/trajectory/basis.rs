//! The four cubic B-splines that are not zero between two knots (Cox 1972, de Boor 1972).

/// Values and derivatives of the four at a time.
pub struct Basis {
    value: [f64; 4],
    first: [f64; 4],
    second: [f64; 4],
}

impl Basis {
    /// At `t` between the third and the fourth of six rising knots.
    pub fn at([k0, k1, k2, k3, k4, k5]: [f64; 6], t: f64) -> Self {
        let linear = [(k3 - t) / (k3 - k2), (t - k2) / (k3 - k2)];
        let pairs = [k3 - k1, k4 - k2];
        let square = [
            linear[0] * (k3 - t) / pairs[0],
            linear[0] * (t - k1) / pairs[0] + linear[1] * (k4 - t) / pairs[1],
            linear[1] * (t - k2) / pairs[1],
        ];
        let triples = [k3 - k0, k4 - k1, k5 - k2];
        let value = [
            square[0] * (k3 - t) / triples[0],
            square[0] * (t - k0) / triples[0] + square[1] * (k4 - t) / triples[1],
            square[1] * (t - k1) / triples[1] + square[2] * (k5 - t) / triples[2],
            square[2] * (t - k2) / triples[2],
        ];
        let [a, b] = [0, 1].map(|n| 2.0 * linear[n] / pairs[n]);
        let square_rate = [-a, a - b, b];
        let rise = |of: [f64; 3]| {
            let [a, b, c] = [0, 1, 2].map(|n| 3.0 * of[n] / triples[n]);
            [-a, a - b, b - c, c]
        };
        Self { value, first: rise(square), second: rise(square_rate) }
    }

    /// Weights of four control points for value, first and second derivative.
    pub fn plain(&self) -> [[f64; 4]; 3] {
        [self.value, self.first, self.second]
    }

    /// Shares of the three steps between four control points, and their first and second derivatives.
    pub fn cumulative(&self) -> [[f64; 3]; 3] {
        self.plain().map(|[_, b, c, d]| [b + c + d, c + d, d])
    }
}

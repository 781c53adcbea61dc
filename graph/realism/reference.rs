//! The statistics of 34 real caves, and the percentile of a value among them.
//!
//! Collon, Bernasconi, Vuilleumier, Renard: "Statistical metrics for the characterization of karst network geometry and
//! topology", Geomorphology 283, 2017, from the table that its authors distribute with karstnet (updated 2021). Three of the
//! caves were surveyed only in plan: their geometry is unknown. Rounded to six decimals.

use super::Metrics;

/// The range of one metric over real caves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Minimum.
    pub min: f64,
    /// Tenth percentile.
    pub p10: f64,
    /// Median.
    pub median: f64,
    /// Ninetieth percentile.
    pub p90: f64,
    /// Maximum.
    pub max: f64,
}

/// A metric: its name, its range, and its value for a graph.
#[derive(Clone, Copy, Debug)]
pub struct Metric {
    /// Its name.
    pub name: &'static str,
    /// Its unit; empty for a ratio.
    pub unit: &'static str,
    /// The range over real caves, quantiles interpolated linearly.
    pub range: Range,
    /// The value of a graph.
    pub of: fn(&Metrics) -> f64,
}

/// Number of [`METRICS`], from the first, that do not depend on the size of a cave. These determine the verdict.
pub const SCALE_FREE: usize = 8;

/// All metrics of real caves, those that do not depend on size first.
pub static METRICS: [Metric; 11] = [
    metric("length entropy", [0.070054, 0.205123, 0.414945, 0.598302, 0.66739], |m| m.length_entropy),
    metric("length variation", [0.903288, 0.940227, 1.322168, 1.85322, 2.559806], |m| m.length_variation),
    metric("tortuosity", [1.121287, 1.183497, 1.26764, 1.415125, 1.535434], |m| m.tortuosity),
    metric("orientation entropy", [0.745735, 0.906844, 0.980899, 0.99586, 0.996994], |m| m.orientation_entropy),
    metric("mean degree", [1.75, 2.0, 2.132804, 2.330473, 2.569231], |m| m.mean_degree),
    metric("degree variation", [0.352617, 0.459572, 0.500401, 0.590435, 0.602927], |m| m.degree_variation),
    metric("degree correlation", [-0.555556, -0.440682, -0.28461, -0.182334, -0.150444], |m| m.degree_correlation),
    metric("central point dominance", [0.022457, 0.205422, 0.437465, 0.541385, 0.571717], |m| {
        m.central_point_dominance
    }),
    in_unit(
        "m",
        metric("mean branch length", [8.464116, 20.705914, 55.612542, 170.794232, 331.735261], |m| m.mean_length_m),
    ),
    in_unit(
        "branches",
        metric("average path", [2.321429, 4.026732, 13.590285, 28.479777, 55.722202], |m| m.average_path),
    ),
    metric("loops", [0.0, 1.3, 18.0, 66.3, 779.0], |m| m.loops as f64),
];

const fn metric(name: &'static str, [min, p10, median, p90, max]: [f64; 5], of: fn(&Metrics) -> f64) -> Metric {
    Metric { name, unit: "", range: Range { min, p10, median, p90, max }, of }
}

const fn in_unit(unit: &'static str, metric: Metric) -> Metric {
    Metric { unit, ..metric }
}

impl Range {
    /// Whether a value is between the minimum and the maximum.
    pub fn holds(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&value)
    }

    /// Whether a value is between the tenth and the ninetieth percentile.
    pub fn has_in_core(&self, value: f64) -> bool {
        (self.p10..=self.p90).contains(&value)
    }
}

/// The percentile of a value among real caves, by the metric's index in [`METRICS`]: 0 at the minimum and below, 100 at the
/// maximum and above, and linear between neighbouring caves, the inverse of numpy's default. If several caves have the same
/// value, the middle of their percentiles.
pub fn percentile(metric: usize, value: f64) -> f64 {
    let mut known: Vec<f64> = CAVES.iter().map(|(_, row)| row[metric]).filter(|value| !value.is_nan()).collect();
    known.sort_unstable_by(f64::total_cmp);
    let below = known.partition_point(|&known| known < value);
    let upto = known.partition_point(|&known| known <= value);
    let place = if below < upto {
        0.5 * (below + upto - 1) as f64
    } else if below == 0 {
        0.0
    } else if below == known.len() {
        (known.len() - 1) as f64
    } else {
        let (low, high) = (known[below - 1], known[below]);
        (below - 1) as f64 + (value - low) / (high - low)
    };
    100.0 * place / (known.len() - 1) as f64
}

/// The metric is unknown for this cave.
const NONE: f64 = f64::NAN;

/// Each cave with its metrics in the order of [`METRICS`], NaN where they are not known.
#[rustfmt::skip]
pub static CAVES: [(&str, [f64; METRICS.len()]); 34] = [
    ("AgenAllwedd", [0.293999, 1.892135, 1.535434, 0.963913, 2.294574, 0.500481, -0.323792, 0.543872, 113.41601, 11.166788, 20.0]),
    ("ArphidiaRobinet", [0.542796, 1.088098, 1.420315, 0.917957, 2.177778, 0.490576, -0.258569, 0.447986, 70.730479, 13.144507, 18.0]),
    ("Arrestelia", [0.212431, 1.492468, 1.347819, 0.906844, 2.025028, 0.571378, -0.232399, 0.498176, 69.736109, 29.156531, 14.0]),
    ("BlueSpring", [NONE, NONE, NONE, NONE, 2.109015, 0.471323, -0.272931, 0.458223, NONE, 26.900684, 27.0]),
    ("Ceberi", [0.39338, 1.350764, 1.26764, 0.971707, 2.075758, 0.514202, -0.368488, 0.298409, 55.612542, 7.198922, 9.0]),
    ("CharentaisHeche", [0.101221, 2.559806, 1.246542, 0.98614, 2.215385, 0.459112, -0.30756, 0.43165, 50.84093, 25.399139, 29.0]),
    ("ClydachGorge_Caf1", [0.501064, 1.56929, 1.183497, 0.745735, 1.75, 0.591485, -0.555556, 0.564626, 331.735261, 2.321429, 0.0]),
    ("ClydachGorge_Ogof_Capel", [0.414945, 1.573142, 1.354889, 0.89229, 2.105263, 0.522614, -0.508516, 0.472041, 50.803424, 3.953216, 2.0]),
    ("Crevice", [NONE, NONE, NONE, NONE, 2.071146, 0.483513, -0.302813, 0.554214, NONE, 19.656346, 10.0]),
    ("Crossroads", [NONE, NONE, NONE, NONE, 2.318059, 0.417452, -0.168386, 0.344071, NONE, 17.332265, 60.0]),
    ("DarenCilau", [0.205123, 1.873754, 1.211818, 0.921221, 2.125356, 0.554713, -0.25519, 0.511424, 55.663986, 18.398795, 23.0]),
    ("EglwysFaen", [0.574202, 1.293556, 1.143507, 0.947478, 2.022727, 0.594853, -0.407082, 0.571717, 15.806543, 8.689916, 2.0]),
    ("FoussoubieEvent", [0.345707, 1.614801, 1.270712, 0.927512, 2.16, 0.481607, -0.283677, 0.473543, 33.200309, 7.865225, 7.0]),
    ("FoussoubieGoule", [0.542673, 1.410948, 1.205059, 0.986993, 2.18543, 0.45956, -0.235854, 0.435979, 62.294731, 25.071154, 29.0]),
    ("GenieBraque", [0.66739, 0.965705, 1.19818, 0.884325, 1.866667, 0.602927, -0.454545, 0.510989, 194.029511, 3.371429, 0.0]),
    ("GrottesDuRoy", [0.606924, 1.099359, 1.239277, 0.980899, 2.145161, 0.489076, -0.248957, 0.314613, 29.756566, 11.189949, 11.0]),
    ("HanSurLesse", [0.528431, 1.258282, 1.121287, 0.975647, 2.569231, 0.352617, -0.150444, 0.196048, 62.057584, 7.135683, 40.0]),
    ("Krubera", [0.324004, 1.85322, 1.302319, 0.996163, 2.059574, 0.587986, -0.401442, 0.453677, 55.835649, 21.409784, 8.0]),
    ("Lechuguilla", [0.414398, 0.920493, 1.256626, 0.99591, 2.371626, 0.520134, -0.15828, 0.493211, 69.278278, 55.722202, 779.0]),
    ("Llangattwg", [0.58208, 1.144147, 1.149691, 0.953875, 1.880597, 0.59647, -0.47609, 0.155994, 15.317508, 3.961146, 1.0]),
    ("MammuthHoehle", [0.116474, 1.274938, 1.415125, 0.99586, 2.335793, 0.535909, -0.300169, 0.022457, 30.59878, 14.423982, 389.0]),
    ("Monachou", [0.551023, 0.903288, 1.243216, 0.983761, 2.175, 0.500321, -0.249738, 0.403962, 8.464116, 7.581013, 8.0]),
    ("OjoDelAgua", [0.397682, 1.426724, 1.21121, 0.963941, 2.263566, 0.47418, -0.221824, 0.377153, 43.81266, 19.574699, 35.0]),
    ("OxBelHa", [0.57001, 0.940227, 1.374853, 0.996994, 2.0, 0.517899, -0.352056, 0.535583, 170.794232, 49.418967, 1.0]),
    ("PicDuJer", [0.598302, 1.135556, 1.209801, 0.932711, 2.0, 0.489898, -0.408333, 0.371067, 25.509351, 5.796923, 18.0]),
    ("Ratasse", [0.334514, 1.595717, 1.414135, 0.986043, 2.033898, 0.555103, -0.395956, 0.438951, 64.267228, 8.265926, 2.0]),
    ("SaintMarcel", [0.286588, 1.770391, 1.2285, 0.992471, 2.140252, 0.515285, -0.27778, 0.227293, 76.103925, 21.66901, 53.0]),
    ("Sakany", [0.377037, 0.914919, 1.400939, 0.9924, 2.395349, 0.470807, -0.16803, 0.267674, 20.705914, 12.618906, 69.0]),
    ("Shuanghe", [0.310369, 1.278022, 1.219754, 0.987796, 2.100189, 0.510155, -0.270052, 0.268923, 118.700471, 25.968279, 56.0]),
    ("SiebenHengsteFull", [0.070054, 1.727695, 1.357682, 0.987848, 2.222976, 0.481199, -0.226263, 0.455955, 36.828321, 47.358939, 231.0]),
    ("SiebenHengstePart1", [0.651989, 1.039906, 1.360985, 0.978121, 2.0, 0.53033, -0.342908, 0.135207, 52.460223, 4.179767, 5.0]),
    ("SiebenHengstePart2", [0.450354, 1.322168, 1.403571, 0.99131, 2.272, 0.4596, -0.285544, 0.492207, 26.97188, 15.498699, 35.0]),
    ("SiebenHengstePart3", [0.532966, 1.214555, 1.428546, 0.990986, 2.282051, 0.469048, -0.214882, 0.39279, 39.521598, 14.036063, 23.0]),
    ("Wakulla", [0.458131, 1.53969, 1.276476, 0.982447, 2.109091, 0.471256, -0.358427, 0.433471, 330.511033, 8.110438, 4.0]),
];

//! Constants of the generator that are not settings.
//!
//! Tuned by random search (November 2026, tens of configurations) until graphs of 50 to 1000 nodes fell inside the
//! range of real caves; no source gives them. Lengths are in metres, angles in radians.

/// One degree.
pub(super) const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Width of a passage per metre of radius assumed by the clearance rule.
pub(super) const WIDTH_PER_RADIUS: f64 = 0.6;
/// Rock left between two passages.
pub(super) const MARGIN_M: f64 = 0.8;
/// Margin in tests before coordinates are rounded to 1 mm.
pub(super) const ROUNDING_M: f64 = 0.003;
/// How near passages one passage apart may come, relative to the required distance.
pub(super) const CROSSING: f64 = 0.35;
/// Minimum angle between two passages at a node.
pub(super) const MIN_JUNCTION: f64 = 55.0 * DEGREE;
/// Most passages at a node.
pub(super) const MAX_DEGREE: usize = 4;

/// Mean radius on trunks, as a fraction between minimum and maximum radius.
pub(super) const TRUNK_REACH: f64 = 0.6;
/// Mean radius on spurs and links, likewise.
pub(super) const SPUR_REACH: f64 = 1.0 / 4.5;
/// Spread of the logarithm of the radius.
pub(super) const REACH_JITTER: f64 = 0.22;
/// Largest growth of the radius from one node to the next.
pub(super) const REACH_GROWTH: f64 = 1.5;
/// Largest shrinkage of the radius from one node to the next.
pub(super) const REACH_SHRINK: f64 = 1.7;

/// Spread of direction on spurs relative to that on trunks.
pub(super) const SPUR_SIGMA: f64 = 50.0 / 34.0;
/// Spread of direction on connectors.
pub(super) const LINK_SIGMA: f64 = 22.0 * DEGREE;
/// Branches longer than this many mean radii bend like trunks.
pub(super) const STRAIGHT_FROM: f64 = 6.0;
/// Fraction by which the heading returns to the bearing of its branch at each step.
pub(super) const BEARING_PULL: f64 = 0.32;
/// Random drift of the bearing at each step.
pub(super) const DRIFT: f64 = 16.0 * DEGREE;
/// Wavelength of the Perlin term on the circle.
pub(super) const PERLIN_SCALE_M: f64 = 14.0;
/// Minimum Perlin weight, so that no direction is impossible.
pub(super) const PERLIN_FLOOR: f64 = 0.01;
/// Strength of the two preferred azimuths.
pub(super) const FRACTURE: f64 = 1.4;
/// Narrowness of the two preferred azimuths.
pub(super) const FRACTURE_KAPPA: f64 = 5.0;
/// Draws on one circle before the branch dies.
pub(super) const DRAWS: usize = 14;
/// Sections excluded on either side of one that failed.
pub(super) const RULED_OUT: usize = 7;

/// Mean length of a branch per mean radius on trunks.
pub(super) const MEAN_LENGTH: f64 = 2.5;
/// Spread of the logarithm of branch lengths.
pub(super) const LENGTH_SIGMA: f64 = 1.5;
/// Nodes per branch, which determines the size of a block of planned lengths.
pub(super) const NODES_PER_BRANCH: f64 = 3.5;
/// How far from the long end of a block trunks draw.
pub(super) const TRUNK_SPREAD: f64 = 0.18;
/// Fraction of a block, from its short end, that spurs draw from.
pub(super) const SPUR_PART: f64 = 0.6;
/// Divisor of the length of a branch for its minimum number of nodes.
pub(super) const NODES_IN_BRANCH: f64 = 9.0;

/// Probability of a third passage at the origin.
pub(super) const THIRD_AT_ORIGIN: f64 = 0.8;
/// Probability of each child beyond the minimum number.
pub(super) const EXTRA_CHILD: f64 = 0.2;
/// Probability that a spur splits in two.
pub(super) const SPUR_SPLITS: f64 = 0.35;
/// Probability that a trunk dies at its end.
pub(super) const TRUNK_DIES: f64 = 0.04;
/// Probability that a side branch is a trunk.
pub(super) const SIDE_TRUNK: f64 = 0.2;
/// Probability that a trunk grows before anything else.
pub(super) const TRUNK_FIRST: f64 = 0.6;
/// Probability that a woken node grows a trunk.
pub(super) const WAKE_TRUNK: f64 = 0.25;
/// Rounds without progress before an attempt gives up.
pub(super) const PATIENCE: usize = 200;

/// Mean degree of the reduced graph aimed at, above 2, at loop closure 1.
pub(super) const EXCESS_DEGREE: [f64; 2] = [0.04, 0.18];
/// Number of branch ends up to which a cave is too small for loops.
pub(super) const FEW_KNOTS: usize = 3;
/// Number of missing loops at which one is closed.
pub(super) const LOOP_SLACK: f64 = 0.6;
/// Longest span of a connector, in mean radii on trunks.
pub(super) const JOIN_DISTANCE: f64 = 5.0;
/// Minimum number of passages between the two ends of a connector.
pub(super) const LOOP_HOPS: u32 = 5;
/// Maximum number of hops counted; anything farther counts as this far.
pub(super) const HOPS_COUNTED: u32 = 40;
/// Tips considered, and candidates tried, per loop.
pub(super) const JOIN_TRIES: usize = 14;
/// Nodes inside passages considered per loop.
pub(super) const MID_TRIES: usize = 4;
/// Weight of the detour in the choice of a loop.
pub(super) const LOOP_BIAS: f64 = 0.25;
/// Maximum random factor on the cost of a connector.
pub(super) const DEAREST: f64 = 1.6;
/// Cost of a connector between layers relative to one within a layer: the paper has several.
pub(super) const LAYER_DISCOUNT: f64 = 0.4;
/// Cost of a connection at a tip relative to one in a passage.
pub(super) const TIP_COST_M: f64 = 6.0;
/// Probability that a main branch is spared by a connector.
pub(super) const KEEP_MAIN: f64 = 0.85;
/// Maximum number of steps of a connector.
pub(super) const LINK_STEPS: usize = 12;
/// Fraction of a connector's bend that remains after each step.
pub(super) const BEND_DECAY: f64 = 0.35;
/// Shortest last leg of a connector, in minimum radii.
pub(super) const LAST_LEG: f64 = 0.8;

/// Minimum inclination of a ramp, relative to the maximum.
pub(super) const GENTLEST_RAMP: f64 = 12.0 / 28.0;
/// Fraction of a layer's share of nodes after which the next layer is opened.
pub(super) const LAYER_SHARE: f64 = 0.92;
/// Fraction of a layer's share of nodes after which links may lead to it.
pub(super) const LINK_SHARE: f64 = 0.5;
/// Passages tried as the end of a link.
pub(super) const LINK_GOALS: usize = 6;
/// Slope from which a link is a shaft, which may start next to a passage.
pub(super) const SHAFT: f64 = 60.0 * DEGREE;
/// Rounds in search of where a link meets the layer below.
pub(super) const SINK_ROUNDS: usize = 24;
/// Nodes tried as the head of a ramp.
pub(super) const RAMP_HEADS: usize = 24;
/// Scale of the relief noise that makes its range match the setting approximately.
pub(super) const RELIEF_GAIN: f64 = 1.6;
/// Wavelength of the relief.
pub(super) const RELIEF_SCALE_M: f64 = 45.0;

/// Side of the plan per square root of the nodes in a layer, in mean radii on trunks, if no bounds are set.
pub(super) const SPREAD: f64 = 2.4;
/// Added to half that side.
pub(super) const SPREAD_RIM_M: f64 = 8.0;

//! The metrics agree with those published for a real cave, and handle degenerate graphs.

use std::fs;

use plume::generators::{GaussianPerlin, Layers, Mine};
use plume::graph::clearance::{PassageSize, thin_rock};
use plume::graph::realism::{CAVES, Gate, Likeness, METRICS, Metrics, RealismSettings, Verdict, percentile};
use plume::graph::{Generator, Graph, NoOutside, Node, StationId};

fn numbers<const N: usize>(file: &str) -> Vec<[f64; N]> {
    let text = fs::read_to_string(format!("tests/data/sakany/{file}")).expect(file);
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split_whitespace().map(|x| x.parse().expect("a number")).collect();
        numbers.try_into().expect("a full row")
    };
    text.lines().map(row).collect()
}

fn graph(places: &[[f64; 3]], edges: &[[usize; 2]]) -> Graph {
    let node = |(id, &place): (usize, &[f64; 3])| Node {
        id: id as u64,
        parent: None,
        position: place.into(),
        radius: 1.0,
        active: false,
        level: 0,
        section: None,
        name: None,
    };
    Graph::new(places.iter().enumerate().map(node).collect(), StationId::pairs(edges.iter().copied()))
}

fn sakany() -> Graph {
    let links: Vec<[usize; 2]> =
        numbers::<2>("Sakany_links.dat").iter().map(|link| link.map(|line| line as usize - 1)).collect();
    graph(&numbers::<3>("Sakany_nodes.dat"), &links)
}

/// A column of the published sheet; empty cells are NaN.
fn column(name: &str) -> Vec<f64> {
    let sheet = fs::read_to_string("tests/data/collon/collon_2017.csv").expect("the sheet");
    let mut lines = sheet.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let titles = lines.next().expect("a line of titles");
    let place = titles.iter().position(|title| *title == name).expect("a column of this name");
    lines.map(|cells| cells[place].parse().unwrap_or(f64::NAN)).collect()
}

/// Columns of the sheet in the order of the table.
const COLUMNS: [&str; METRICS.len()] = ["Hl", "CVl", "t", "H0", "kmoy", "CVk", "rk", "CPD", "len_moy", "SPL", "Ncycl"];

#[test]
fn the_metrics_of_sakany_are_the_published_ones() {
    let metrics = Metrics::of(&sakany()).unwrap();
    let row = CAVES.iter().position(|(name, _)| *name == "Sakany").unwrap();
    for (metric, title) in METRICS.iter().zip(COLUMNS) {
        let (value, published) = ((metric.of)(&metrics), column(title)[row]);
        assert!((value - published).abs() < 1e-6, "{}: {value}, {published}", metric.name);
    }
    assert_eq!((metrics.branches, metrics.max_degree, metrics.sampling), (361, 5, None));
}

#[test]
fn the_table_of_caves_is_the_published_sheet() {
    for (place, (metric, title)) in METRICS.iter().zip(COLUMNS).enumerate() {
        let published = column(title);
        assert_eq!(published.len(), CAVES.len());
        for ((name, row), published) in CAVES.iter().zip(published) {
            let same = row[place].is_nan() && published.is_nan() || (row[place] - published).abs() <= 5e-7;
            assert!(same, "{name} {}: {}, {published}", metric.name, row[place]);
        }
    }
}

/// The quantile of sorted values, interpolated like numpy's.
fn quantile(sorted: &[f64], part: f64) -> f64 {
    let place = part * (sorted.len() - 1) as f64;
    let low = sorted[place as usize];
    low + (sorted[(place as usize + 1).min(sorted.len() - 1)] - low) * place.fract()
}

#[test]
fn ranges_follow_from_the_caves_and_percentiles_invert_them() {
    for (place, metric) in METRICS.iter().enumerate() {
        let mut known: Vec<f64> = CAVES.iter().map(|(_, row)| row[place]).filter(|x| !x.is_nan()).collect();
        known.sort_by(f64::total_cmp);
        let range = metric.range;
        for (part, value) in
            [(0.0, range.min), (0.1, range.p10), (0.5, range.median), (0.9, range.p90), (1.0, range.max)]
        {
            assert!((quantile(&known, part) - value).abs() < 2e-6, "{} {part}", metric.name);
            // Several caves may share a value; their mid-rank counts.
            let off = (percentile(place, quantile(&known, part)) - 100.0 * part).abs();
            assert!(off <= 100.0 / (known.len() - 1) as f64 + 1e-9, "{} {part}: {off}", metric.name);
        }
        assert_eq!(percentile(place, range.min - 1.0), 0.0);
        assert_eq!(percentile(place, range.max + 1.0), 100.0);
    }
}

/// The rule accepts most of the caves that it was derived from; Sakany is not among them.
#[test]
fn real_caves_are_like_real_caves() {
    let geometry = CAVES.iter().filter(|(_, row)| row.iter().all(|value| !value.is_nan()));
    let is_core = |(value, place): (&f64, usize)| METRICS[place].range.has_in_core(*value);
    let core = |row: &[f64]| row.iter().zip(0..8).filter(|&pair| is_core(pair)).count();
    let passed = geometry.filter(|(_, row)| core(row) >= 6).count();
    assert_eq!(passed, 21);
    assert_eq!(Likeness::of(&sakany()).unwrap().verdict, Verdict::Unusual);
}

#[test]
fn a_star_is_not_like_a_cave() {
    let places = [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [-5.0, 0.0, 0.0]];
    let metrics = Metrics::of(&graph(&places, &[[0, 1], [0, 2], [0, 3]])).unwrap();
    assert_eq!(metrics.central_point_dominance, 1.0);
    assert_eq!(metrics.degree_correlation, -1.0);
    assert_eq!((metrics.mean_degree, metrics.tortuosity), (1.5, 1.0));
    assert!(!metrics.realism(0.0).is_real());
    assert!(metrics.distance() > 1.0);
}

#[test]
fn lines_and_rings_are_measured_and_too_small_to_judge() {
    let places = [[0.0; 3], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0]];
    let line = Likeness::of(&graph(&places, &[[0, 1], [1, 2]])).unwrap();
    assert_eq!((line.metrics.tortuosity, line.metrics.length_variation), (1.4, 0.0));
    let ring = Likeness::of(&graph(&places, &[[0, 1], [1, 2], [0, 2]])).unwrap();
    assert_eq!((ring.metrics.mean_length_m, ring.metrics.loops, ring.metrics.tortuosity), (12.0, 1, 1.0));
    let long: Vec<[f64; 3]> = (0..90).map(|i| [f64::from(i), f64::from(i * i % 7), 0.0]).collect();
    let long = Likeness::of(&graph(&long, &(1..90).map(|i| [i - 1, i]).collect::<Vec<_>>())).unwrap();
    for likeness in [line, ring, long] {
        assert!(likeness.rows().all(|row| row.value.is_finite()));
        assert_eq!(likeness.verdict, Verdict::TooSmall);
    }
    assert_eq!(Metrics::of(&graph(&places, &[])), None);
}

#[test]
fn parts_count_by_their_nodes() {
    // A path of three branches through two forks, and a single branch: 6 nodes at 1.8 on average, 2 nodes at 1.
    let places: Vec<[f64; 3]> = (0..8).map(|i| [f64::from(i), f64::from(i * i), 0.0]).collect();
    let metrics = Metrics::of(&graph(&places, &[[0, 1], [1, 2], [1, 3], [3, 4], [3, 5], [6, 7]])).unwrap();
    assert!((metrics.average_path - (6.0 * 29.0 / 15.0 + 2.0) / 8.0).abs() < 1e-12, "{}", metrics.average_path);
}

/// A ring on a stalk keeps two of its stations in the reduced graph, so it stays a ring there.
#[test]
fn rings_and_parallel_branches_do_not_collapse() {
    let places: Vec<[f64; 3]> = (0..7).map(|i| [f64::from(i), f64::from(i * i), 0.0]).collect();
    let stalk = graph(&places[..5], &[[0, 1], [1, 2], [2, 3], [3, 4], [1, 4]]);
    let metrics = Metrics::of(&stalk).unwrap();
    // Degrees 1, 3, 2, 2.
    assert_eq!(metrics.mean_degree, 2.0);
    let eyes = [[0, 1], [1, 2], [2, 3], [1, 4], [4, 5], [5, 3], [3, 6]];
    let metrics = Metrics::of(&graph(&places, &eyes)).unwrap();
    // Degrees 1, 3, 3, 1 and 2 for the middle of each parallel branch.
    assert_eq!(metrics.mean_degree, 2.0);
}

/// Drifts at right angles: as unlike a cave as a graph can be.
fn mine(nodes: u32) -> Mine {
    Mine { nodes, ..Mine::default() }
}

fn gate(gate: Gate, tries: u32) -> RealismSettings {
    RealismSettings { gate, tries }
}

#[test]
fn an_open_gate_changes_nothing() {
    let straight = mine(120).generate(5, &NoOutside);
    assert_eq!(RealismSettings::default().generate(&mine(120), 5, &NoOutside), straight);
    let cave = GaussianPerlin::default();
    for kind in [Gate::Reject, Gate::Repair] {
        assert_eq!(gate(kind, 3).generate(&cave, 5, &NoOutside), cave.generate(5, &NoOutside));
    }
}

#[test]
fn a_gate_that_rejects_tries_other_seeds_and_tells_what_fails() {
    let loose = Layers::default();
    let judged = |graph: &Graph| Likeness::of(graph).unwrap().verdict;
    let unlike = (0..60).find(|&seed| judged(&loose.generate(seed, &NoOutside).unwrap()) != Verdict::Real);
    let seed = unlike.expect("some seed makes another graph");
    let graph = gate(Gate::Reject, 200).generate(&loose, seed, &NoOutside).unwrap();
    assert_eq!(judged(&graph), Verdict::Real);
    assert_eq!(gate(Gate::Reject, 200).generate(&loose, seed, &NoOutside).unwrap(), graph);
    let error = gate(Gate::Reject, 3).generate(&mine(120), 5, &NoOutside).unwrap_err();
    insta::assert_snapshot!("none_passes", format!("{error}\n{}", error.hint));
    let error = gate(Gate::Repair, 3).generate(&mine(20), 5, &NoOutside).unwrap_err();
    insta::assert_snapshot!("too_small", format!("{error}\n{}", error.hint));
}

#[test]
fn repaired_mines_are_like_caves_and_keep_their_laws() {
    for (nodes, levels, seed) in [(120, 1, 1), (120, 1, 2), (250, 1, 3), (250, 3, 4)] {
        let mine = Mine { levels, ..mine(nodes) };
        let before = mine.generate(seed, &NoOutside).unwrap();
        let graph = gate(Gate::Repair, 2).generate(&mine, seed, &NoOutside).unwrap();
        let name = format!("{nodes} nodes, {levels} levels, seed {seed}");
        let likeness = Likeness::of(&graph).unwrap();
        assert_eq!(likeness.verdict, Verdict::Real, "{name}: {:?}", likeness.failing());
        assert_eq!(gate(Gate::Repair, 2).generate(&mine, seed, &NoOutside).unwrap(), graph, "{name}");
        assert_eq!(graph.components().len(), 1, "{name}");
        assert!(graph.neighbors().iter().all(|others| (1..=4).contains(&others.len())), "{name}");
        assert!((6 * before.nodes.len() / 10..=16 * before.nodes.len() / 10).contains(&graph.nodes.len()), "{name}");
        assert!(graph.nodes.iter().all(|node| node.section == before.nodes[0].section), "{name}");
        assert!((0..levels).all(|level| graph.nodes.iter().any(|node| node.level == level)), "{name}");
        let parents = graph.nodes.iter().enumerate().skip(1);
        assert!(parents.into_iter().all(|(i, node)| node.parent.is_some_and(|parent| parent.index() < i)), "{name}");
        let thin = |graph: &Graph| thin_rock(graph, PassageSize::default(), 0.8).len();
        assert!(thin(&graph) <= thin(&before), "{name}");
    }
}

//! The metrics agree with those published for a real cave, and judge graphs that are none.

use std::fs;

use plume::graph::metrics::{Metrics, REAL_CAVES};
use plume::graph::{Graph, Node};

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
    };
    Graph::new(places.iter().enumerate().map(node).collect(), edges.to_vec())
}

/// Rows of Collon et al. 2017: Hl, CVl, t, H0, kmoy, CVk, rk, CPD.
#[test]
fn the_metrics_of_sakany_are_the_published_ones() {
    let links: Vec<[usize; 2]> =
        numbers::<2>("Sakany_links.dat").iter().map(|link| link.map(|line| line as usize - 1)).collect();
    let metrics = Metrics::of(&graph(&numbers::<3>("Sakany_nodes.dat"), &links)).unwrap();
    let published = [
        0.3770371929469133,
        0.91491869803329,
        1.400939172515553,
        0.9924004494770278,
        2.395348837209302,
        0.4708073224868529,
        -0.1680304630939378,
        0.2676740749944755,
    ];
    for ((value, published), range) in metrics.values().iter().zip(published).zip(&REAL_CAVES) {
        assert!((value - published).abs() < 1e-6, "{}: {value}, {published}", range.name);
        assert!((range.min..=range.max).contains(value));
    }
    assert_eq!(metrics.realism(0.0).inside, 8);
}

#[test]
fn ranges_are_in_order() {
    for range in &REAL_CAVES {
        assert!(range.min <= range.p10 && range.p10 < range.p90 && range.p90 <= range.max);
    }
}

#[test]
fn a_star_is_all_centre_and_no_cave() {
    let places = [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [-5.0, 0.0, 0.0]];
    let metrics = Metrics::of(&graph(&places, &[[0, 1], [0, 2], [0, 3]])).unwrap();
    assert_eq!(metrics.central_point_dominance, 1.0);
    assert_eq!(metrics.degree_correlation, -1.0);
    assert_eq!((metrics.mean_degree, metrics.tortuosity), (1.5, 1.0));
    assert!(!metrics.realism(0.0).is_real());
    assert!(metrics.distance() > 1.0);
}

#[test]
fn a_line_is_measured_and_a_ring_is_not() {
    let places = [[0.0; 3], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0]];
    let line = Metrics::of(&graph(&places, &[[0, 1], [1, 2]])).unwrap();
    assert_eq!((line.tortuosity, line.length_variation), (1.4, 0.0));
    assert!(line.values().iter().all(|value| value.is_finite()));
    assert_eq!(Metrics::of(&graph(&places, &[[0, 1], [1, 2], [0, 2]])), None);
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

//! The laws of networks that are dug passage by passage, held by every generator that does.

use crate::common::segment;
use crate::common::world;
use nalgebra::{Point3, Vector3};
use plume::generators::GENERATORS;
use plume::graph::{GenerateError, Graph, Neighbors, Node, StationId};
use segment::distance;
use serde_json::{Value, json};
use world::World;

/// A generator, settings that stress it, and their consequences for its law.
struct Case {
    name: &'static str,
    settings: Value,
    rock_m: f64,
    steepest_deg: f64,
    junction_deg: f64,
}

impl Case {
    /// Distance that axes keep while they are dug. Colonies are dug as wide as they may become.
    fn dug_m(&self) -> f64 {
        if self.name == "space-colonization" { 5.0 + self.rock_m } else { 0.0 }
    }
}

fn case(name: &'static str, settings: Value, [rock_m, steepest_deg, junction_deg]: [f64; 3]) -> Case {
    Case { name, settings, rock_m, steepest_deg, junction_deg }
}

fn cases() -> Vec<Case> {
    vec![
        case("grown-tunnels", json!({"nodes": 300}), [6.0, 20.0, 50.0]),
        case("grown-tunnels", json!({"nodes": 200, "rock_m": 1.0, "connectors": 2.0}), [1.0, 20.0, 50.0]),
        case("grown-tunnels", json!({"nodes": 200, "max_inclination_deg": 8.0}), [6.0, 8.0, 50.0]),
        case("worms", json!({"nodes": 300}), [1.0, 20.0, 50.0]),
        case("worms", json!({"nodes": 200, "depth_m": 60.0, "rock_m": 3.0}), [3.0, 20.0, 50.0]),
        case(
            "worms",
            json!({"nodes": 200, "step_m": 2.0, "max_slope_deg": 5.0, "loop_closure": 2.0}),
            [1.0, 5.0, 50.0],
        ),
        case("space-colonization", json!({"nodes": 300}), [1.0, 20.0, 50.0]),
        case("space-colonization", json!({"nodes": 200, "height_m": 60.0, "rock_m": 2.0}), [2.0, 20.0, 50.0]),
        case("space-colonization", json!({"nodes": 200, "region": "box", "loop_closure": 2.0}), [1.0, 20.0, 50.0]),
        case("l-system", json!({"nodes": 300}), [1.0, 20.0, 50.0]),
        case("l-system", json!({"nodes": 200, "axiom": "F", "rules": ["F = F[+F]F[-F]F"]}), [1.0, 20.0, 50.0]),
    ]
}

fn hold(law: impl Fn(&Case, &Graph, &str)) {
    for case in cases() {
        let row = GENERATORS.find(case.name).unwrap();
        let made = (row.read)(case.settings.clone()).unwrap();
        for seed in 0..5 {
            let graph = made.generate(seed, &World).unwrap();
            law(&case, &graph, &format!("{} {} seed {seed}", case.name, case.settings));
        }
    }
}

fn floor(node: &Node) -> Point3<f64> {
    node.position - Vector3::z() * node.section.unwrap().axis_height_m()
}

#[test]
fn no_floor_is_steeper_than_asked() {
    hold(|case, graph, name| {
        for &[a, b] in &graph.edges {
            let way = floor(&graph[b]) - floor(&graph[a]);
            // Four millimetres are what rounding axes and floors at both ends may add.
            let rise = way.z.abs() - 0.004;
            assert!(libm::atan2(rise, way.xy().norm()).to_degrees() <= case.steepest_deg, "{name} {a:?}-{b:?}");
        }
    });
}

/// A metre from where passages part, the floor between them is no steeper than that of a passage may be.
#[test]
fn passages_part_gently() {
    hold(|case, graph, name| {
        for (node, others) in graph.stations().zip(graph.neighbors().iter()) {
            let a_metre_on = |other: &StationId| {
                let way = floor(&graph[*other]) - floor(&graph[node]);
                way / way.xy().norm()
            };
            for (place, a) in others.iter().enumerate() {
                for b in &others[place + 1..] {
                    let apart = a_metre_on(a) - a_metre_on(b);
                    // What rounding may add.
                    let rise = apart.z.abs() - 0.01;
                    let slope_deg = libm::atan2(rise, apart.xy().norm()).to_degrees();
                    assert!(slope_deg <= case.steepest_deg, "{name} {node:?}: {slope_deg}° from {a:?} to {b:?}");
                }
            }
        }
    });
}

#[test]
fn passages_at_a_station_keep_their_angles() {
    hold(|case, graph, name| {
        for (node, others) in graph.stations().zip(graph.neighbors().iter()) {
            assert!(others.len() <= 4, "{name} {node:?}");
            let way = |other: StationId| floor(&graph[other]) - floor(&graph[node]);
            for (place, &a) in others.iter().enumerate() {
                for &b in &others[place + 1..] {
                    assert!(way(a).angle(&way(b)).to_degrees() > case.junction_deg - 0.1, "{name} {node:?}");
                }
            }
        }
    });
}

/// Where the rock between two passages is thin, a short path connects them.
#[test]
fn no_passage_runs_through_another() {
    hold(|case, graph, name| {
        let neighbors = graph.neighbors();
        for (place, &first) in graph.edges.iter().enumerate() {
            for &second in &graph.edges[place + 1..] {
                let need = clearance_radius(graph, first) + clearance_radius(graph, second) + case.rock_m;
                let ends = |ends: [StationId; 2]| ends.map(|end| graph[end].position);
                let apart = distance(ends(first), ends(second));
                if apart < need - 0.01 && !is_joined(graph, &neighbors, first, second, 2.0 * need.max(case.dug_m())) {
                    panic!("{name}: {first:?} and {second:?} are {apart} m apart");
                }
            }
        }
    });
}

#[test]
fn loops_are_made_on_request() {
    for (name, key) in [
        ("grown-tunnels", "connectors"),
        ("worms", "loop_closure"),
        ("space-colonization", "loop_closure"),
        ("l-system", "loop_closure"),
    ] {
        let loops = |closure: f64| {
            let made = (GENERATORS.find(name).unwrap().read)(json!({"nodes": 250, key: closure})).unwrap();
            (0..24).map(|seed| made.generate(seed, &World).unwrap().loops()).sum::<usize>()
        };
        assert_eq!(loops(0.0), 0, "{name}");
        assert!(loops(1.0) > 24 && loops(2.0) > loops(1.0), "{name}");
    }
}

#[test]
fn worms_stay_within_their_depths_and_widths() {
    let made = (GENERATORS.find("worms").unwrap().read)(json!({"nodes": 400, "depth_m": 6.0})).unwrap();
    for seed in 0..5 {
        for node in made.generate(seed, &World).unwrap().nodes {
            assert!(node.position.z.abs() <= 3.001, "seed {seed}: {}", node.position);
            assert!((2.0..=5.0).contains(&node.section.unwrap().width_m), "seed {seed}");
        }
    }
}

/// Where passages join, their widths to the exponent add up, as long as none is the widest.
#[test]
fn widths_follow_the_pipe_model() {
    let lengths = json!({"step_m": 8.0, "kill_m": 16.0, "influence_m": 60.0, "width_max_m": 9.0});
    let mut settings = json!({"nodes": 200, "loop_closure": 0.0, "pipe_exponent": 2.0});
    settings.as_object_mut().unwrap().extend(lengths.as_object().unwrap().clone());
    let made = (GENERATORS.find("space-colonization").unwrap().read)(settings).unwrap();
    let graph = made.generate(1, &World).unwrap();
    let area = |node: StationId| {
        let width_m = graph[node].section.unwrap().width_m;
        width_m * width_m
    };
    for node in graph.stations() {
        let children = graph.stations().filter(|&child| graph[child].parent == Some(node));
        let fed = children.map(area).sum::<f64>().max(4.0);
        assert!((area(node) / fed.min(81.0) - 1.0).abs() < 0.01, "{node:?}: {} of {fed}", area(node));
    }
}

fn grammar(axiom: &str, rules: &[&str], nodes: u32) -> Result<Graph, GenerateError> {
    let settings = json!({"axiom": axiom, "rules": rules, "nodes": nodes});
    (GENERATORS.find("l-system").unwrap().read)(settings).unwrap().generate(1, &World)
}

#[test]
fn errors_of_grammars_name_the_rule_and_the_character() {
    let faulty: [(&str, &[&str]); 9] = [
        ("A", &["A = F[+A"]),
        ("A", &["A = FA", "A = F]A"]),
        ("A", &["A = F?A"]),
        ("F(", &[]),
        ("A", &["A FA"]),
        ("A", &["+ = FA"]),
        ("A", &["A -1 = FA"]),
        ("A", &["A = A[B]", "B = AB"]),
        ("", &[]),
    ];
    let told = faulty.map(|(axiom, rules)| {
        let error = grammar(axiom, rules, 20).unwrap_err();
        format!("{error}\n  {}", error.hint)
    });
    insta::assert_snapshot!(told.join("\n"));
}

#[test]
fn hostile_grammars_terminate() {
    for rule in ["A = [A][A][A]AF", "A = AA", "A = [[[[A]]]]A", "A = F[A][A][A][A][A][A]"] {
        let graph = grammar("AF", &[rule], 300).map(|graph| graph.nodes.len());
        assert!(graph.as_ref().is_ok_and(|nodes| *nodes == 300) || graph.is_err(), "{rule}");
    }
}

fn clearance_radius(graph: &Graph, ends: [StationId; 2]) -> f64 {
    let of = |node: &Node| {
        let section = node.section.expect("what is dug has a size");
        (section.width_m / 2.0).max(section.height_m / 1.5)
    };
    ends.map(|end| of(&graph[end])).into_iter().fold(0.0, f64::max)
}

/// Whether a path of at most this length connects an end of one passage to an end of the other.
fn is_joined(
    graph: &Graph,
    neighbors: &Neighbors<Node>,
    from: [StationId; 2],
    to: [StationId; 2],
    most_m: f64,
) -> bool {
    let mut open: Vec<(StationId, f64)> = from.map(|end| (end, 0.0)).into();
    let mut least = vec![f64::INFINITY; graph.nodes.len()];
    while let Some((node, walked)) = open.pop() {
        if to.contains(&node) {
            return true;
        }
        if walked >= least[node.index()] {
            continue;
        }
        least[node.index()] = walked;
        let onward = neighbors[node].iter().map(|&other| (other, walked + graph.distance_m(node, other)));
        open.extend(onward.filter(|(_, walked)| *walked <= most_m));
    }
    false
}

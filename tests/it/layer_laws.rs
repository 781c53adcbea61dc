//! The laws of graphs with several layers: links counted, spaced and within their slopes, rock between layers.

use std::collections::BTreeSet;

use crate::common::world;
use nalgebra::Vector3;
use plume::generators::GENERATORS;
use plume::graph::clearance::{PassageSize, RockReport, thin_rock};
use plume::graph::{Graph, Node, StationId};
use serde_json::{Value, json};
use world::World;

const SEEDS: u64 = 6;

fn make(name: &str, settings: &Value, seed: u64) -> Graph {
    let row = GENERATORS.find(name).expect("it has a row");
    let generator = (row.read)(settings.clone()).expect("the settings are its own");
    generator.generate(seed, &World).unwrap_or_else(|error| panic!("{settings} seed {seed}: {error}"))
}

/// A cave without relief, so that links alone have a slope.
fn flat_cave() -> Value {
    json!({"generator": "gaussian-perlin", "nodes": 60, "relief_m": 0.0})
}

/// Stacks of flat layers with their number of links.
fn stacks() -> Vec<Value> {
    let mine = json!({"generator": "mine", "nodes": 90});
    vec![
        json!({"layer": [flat_cave(), flat_cave()]}),
        json!({"layer": [mine, flat_cave()], "link_count": 3, "link_min_deg": 6.0, "link_max_deg": 12.0}),
        json!({"layer": [flat_cave(), mine, flat_cave()], "link_max_deg": 35.0, "link_spacing_m": 25.0}),
        json!({"layer": [mine, flat_cave()], "link_min_deg": 90.0, "link_max_deg": 90.0, "link_count": 4}),
        json!({"layer": [flat_cave(), flat_cave()], "link_min_deg": 70.0, "link_max_deg": 85.0, "link_count": 1}),
    ]
}

fn setting(settings: &Value, key: &str) -> f64 {
    let schema = (GENERATORS.find("layers").unwrap().schema)().to_value();
    settings[key].as_f64().or_else(|| schema["properties"][key]["default"].as_f64()).unwrap()
}

fn slope_deg(graph: &Graph, [a, b]: [StationId; 2]) -> f64 {
    let way = graph[b].position - graph[a].position;
    libm::atan2(way.z.abs(), way.xy().norm()).to_degrees()
}

/// Runs of sloping passages, each from its top station to its bottom station. Level passages separate them.
fn runs(graph: &Graph, steep: &[[StationId; 2]]) -> Vec<[StationId; 2]> {
    let mut ends = Vec::new();
    let mut left: BTreeSet<[StationId; 2]> = steep.iter().copied().collect();
    while let Some(first) = left.pop_first() {
        let mut stations: BTreeSet<StationId> = first.into();
        while let Some(next) = left.iter().find(|edge| edge.iter().any(|end| stations.contains(end))).copied() {
            left.remove(&next);
            stations.extend(next);
        }
        let height = |&&station: &&StationId| (graph[station].position.z * 1000.0) as i64;
        let [top, bottom] = [stations.iter().max_by_key(height), stations.iter().min_by_key(height)];
        ends.push([*top.unwrap(), *bottom.unwrap()]);
    }
    ends
}

#[test]
fn links_are_counted_and_spaced_and_keep_their_slopes() {
    for settings in stacks() {
        let range = setting(&settings, "link_min_deg") - 0.05..=setting(&settings, "link_max_deg") + 0.05;
        let [count, spacing_m] = ["link_count", "link_spacing_m"].map(|key| setting(&settings, key));
        for seed in 0..SEEDS {
            let graph = make("layers", &settings, seed);
            let is_steep = |edge: &&[StationId; 2]| slope_deg(&graph, **edge) > 0.0;
            let mut steep: Vec<[StationId; 2]> = graph.edges.iter().filter(is_steep).copied().collect();
            for &edge in &steep {
                let slope = slope_deg(&graph, edge);
                assert!(range.contains(&slope), "{settings} seed {seed}: {slope}");
            }
            for pair in 1..settings["layer"].as_array().unwrap().len() as u32 {
                let leads_to = |edge: &[StationId; 2]| edge.iter().map(|&end| graph[end].level).max() == Some(pair);
                let (these, rest) = steep.into_iter().partition(leads_to);
                steep = rest;
                let links = runs(&graph, &these);
                assert_eq!(links.len(), count as usize, "{settings} seed {seed}");
                for (place, link) in links.iter().enumerate() {
                    assert_eq!(link.map(|end| graph[end].level), [pair - 1, pair], "{settings} seed {seed}");
                    for (end, other) in links[..place].iter().flat_map(|other| [0, 1].map(|end| (end, other))) {
                        let [a, b] = [link[end], other[end]].map(|station| graph[station].position.xy());
                        assert!((a - b).norm() >= spacing_m - 0.002, "{settings} seed {seed}: {}", (a - b).norm());
                    }
                }
            }
        }
    }
}

#[test]
fn links_within_a_cave_are_counted_and_spaced_and_keep_their_slopes() {
    for (links, least, greatest, spacing_m) in [
        (2, 10.0, 28.0, 15.0),
        (3, 80.0, 90.0, 10.0),
        (2, 12.0, 16.0, 0.0),
        (1, 90.0, 90.0, 10.0),
        (2, 40.0, 60.0, 12.0),
    ] {
        let settings = json!({"nodes": 150, "layers": 3, "relief_m": 0.0, "links": links, "ramp_min_deg": least,
                              "ramp_max_deg": greatest, "link_spacing_m": spacing_m});
        for seed in 0..SEEDS {
            let graph = make("gaussian-perlin", &settings, seed);
            let is_steep = |edge: &&[StationId; 2]| slope_deg(&graph, **edge) > 0.0;
            let steep: Vec<[StationId; 2]> = graph.edges.iter().filter(is_steep).copied().collect();
            for &edge in &steep {
                let slope = slope_deg(&graph, edge);
                assert!((least - 0.05..=greatest + 0.05).contains(&slope), "{settings} seed {seed}: {slope}");
            }
            for pair in 1..3 {
                let leads_to = |edge: &&[StationId; 2]| edge.iter().map(|&end| graph[end].level).max() == Some(pair);
                let these: Vec<[StationId; 2]> = steep.iter().filter(leads_to).copied().collect();
                let found = runs(&graph, &these);
                assert_eq!(found.len(), links, "{settings} seed {seed}");
                for (place, link) in found.iter().enumerate() {
                    for (end, other) in found[..place].iter().flat_map(|other| [0, 1].map(|end| (end, other))) {
                        let [a, b] = [link[end], other[end]].map(|station| graph[station].position.xy());
                        assert!((a - b).norm() >= spacing_m - 0.002, "{settings} seed {seed}: {}", (a - b).norm());
                    }
                }
            }
        }
    }
}

/// Half the width and height of the passage at a station, by the formulas of the recipe's [passage] section.
fn half([a, b]: [&Node; 2]) -> [f64; 2] {
    let of = |node: &Node| match node.section {
        Some(section) => [0.5 * section.width_m, section.height_m / 1.8],
        None => [0.5, 0.55].map(|part| part * (0.6 * node.radius).max(1.4)),
    };
    [0, 1].map(|axis| of(a)[axis].max(of(b)[axis]))
}

/// Path lengths along passages between all stations.
fn ways(graph: &Graph) -> Vec<Vec<f64>> {
    let count = graph.nodes.len();
    let mut ways = vec![vec![f64::INFINITY; count]; count];
    for &[a, b] in &graph.edges {
        let length_m = graph.distance_m(a, b);
        let [a, b] = [a, b].map(StationId::index);
        (ways[a][b], ways[b][a]) = (length_m, length_m);
    }
    for middle in 0..count {
        for from in 0..count {
            for to in 0..count {
                ways[from][to] = ways[from][to].min(ways[from][middle] + ways[middle][to]);
            }
        }
    }
    ways
}

/// The least rock between passages that the law is about, by points along their axes and ellipses round them.
fn least_rock(graph: &Graph, asked_m: f64, is_asked: impl Fn([StationId; 2], [StationId; 2]) -> bool) -> f64 {
    let (ways, neighbors) = (ways(graph), graph.neighbors());
    let near = |a: StationId, b: StationId| a == b || neighbors[a].contains(&b);
    let mut least = f64::INFINITY;
    for (place, &one) in graph.edges.iter().enumerate() {
        for &other in graph.edges[..place].iter().filter(|&&other| is_asked(one, other)) {
            let ends = one.map(|a| other.map(|b| (near(a, b), ways[a.index()][b.index()]))).concat();
            let sizes = [one, other].map(|edge| half(edge.map(|end| &graph[end])));
            let need: f64 = sizes.iter().map(|[width, height]| width.max(*height)).sum();
            if ends.iter().any(|&(touch, way)| touch || way <= 2.0 * (1.19 * need + asked_m)) {
                continue;
            }
            let at = |[a, b]: [StationId; 2], share: f64| {
                let [a, b] = [a, b].map(|end| graph[end].position);
                a + (b - a) * share
            };
            for step in 0..81 {
                let [s, t] = [step / 9, step % 9].map(|part| f64::from(part) / 8.0);
                let between: Vector3<f64> = at(other, t) - at(one, s);
                let away = between.norm().max(1e-9);
                let [flat, up] = [between.xy().norm() / away, between.z.abs() / away];
                let reach = |[width, height]: [f64; 2]| 1.0 / libm::hypot(flat / width, up / height);
                least = least.min(away - reach(sizes[0]) - reach(sizes[1]));
            }
        }
    }
    least
}

#[test]
fn rock_stays_between_layers_and_round_links() {
    let cave = json!({"generator": "gaussian-perlin", "nodes": 50});
    let deep = json!({"generator": "gaussian-perlin", "nodes": 50, "depth_m": 2.0, "relief_m": 6.0});
    let small = json!({"generator": "file", "depth_m": 30.0});
    let mine = json!({"generator": "mine", "nodes": 90});
    let mut stacks = stacks();
    stacks.push(json!({"layer": [mine, small], "link_count": 1, "link_max_deg": 30.0}));
    stacks.push(json!({"layer": [cave, deep, cave]}));
    stacks.push(json!({"layer": [cave, deep], "rock_min_m": 5.0, "link_max_deg": 40.0}));
    for settings in stacks {
        let asked_m = setting(&settings, "rock_min_m");
        for seed in 0..SEEDS / 2 {
            let graph = make("layers", &settings, seed);
            let levels = |[a, b]: [StationId; 2]| [graph[a].level, graph[b].level];
            let apart = |one, other| !levels(one).iter().any(|level| levels(other).contains(level));
            let least_m = least_rock(&graph, asked_m, apart);
            assert!(least_m >= asked_m, "{settings} seed {seed}: {least_m}");
            let report = RockReport::of(&graph, PassageSize::default(), asked_m);
            assert_eq!(report.thin_between_levels, 0, "{settings} seed {seed}: {report:?}");
        }
    }
}

#[test]
fn layers_that_may_break_into_each_other_are_told_of() {
    let mine = json!({"generator": "mine", "nodes": 200});
    let cave = json!({"generator": "gaussian-perlin", "depth_m": 4.0});
    let settings = json!({"layer": [mine, cave], "thin_rock": "allow", "rock_min_m": 0.0,
                          "link_count": 1, "link_min_deg": 30.0, "link_max_deg": 90.0});
    let (mut found, mut graphs) = (0, 0);
    for seed in 0..20 {
        let row = GENERATORS.find("layers").unwrap();
        let Ok(graph) = (row.read)(settings.clone()).unwrap().generate(seed, &World) else { continue };
        graphs += 1;
        found += RockReport::of(&graph, PassageSize::default(), 1.0).breakthroughs_between_levels;
    }
    assert!(graphs > 0 && found > 0, "{found} in {graphs}");
}

#[test]
fn what_finds_no_room_is_told_with_what_to_change() {
    let refused = |settings: Value| {
        let row = GENERATORS.find("layers").unwrap();
        let generator = (row.read)(settings).unwrap();
        let error = generator.generate(1, &World).unwrap_err();
        format!("{error}\n{}", error.hint)
    };
    insta::assert_snapshot!("too_many_links", refused(json!({"link_count": 30})));
    insta::assert_snapshot!("slopes_the_wrong_way_round", refused(json!({"link_min_deg": 40.0, "link_max_deg": 20.0})));
    insta::assert_snapshot!("one_layer", refused(json!({"layer": [flat_cave()]})));
    let deep = json!({"generator": "mine", "depth_m": 20.0});
    insta::assert_snapshot!("depths_the_wrong_way_round", refused(json!({"layer": [deep, deep]})));
    let crowded = json!({"nodes": 40, "layers": 2, "links": 20});
    let row = GENERATORS.find("gaussian-perlin").unwrap();
    let error = (row.read)(crowded).unwrap().generate(1, &World).unwrap_err();
    insta::assert_snapshot!("too_many_links_in_a_cave", format!("{error}\n{}", error.hint));
    let nested = json!({"generator": "layers"});
    insta::assert_snapshot!("layers_in_layers", refused(json!({"layer": [flat_cave(), nested]})));
    let mistyped = json!({"generator": "mine", "drifs": 3});
    insta::assert_snapshot!("key_in_a_layer", refused(json!({"layer": [flat_cave(), mistyped]})));
    let tight = json!({"generator": "mine", "nodes": 4, "levels": 4});
    insta::assert_snapshot!("layer_without_room", refused(json!({"layer": [flat_cave(), tight]})));
}

/// Two straight passages and a detour that is too long to count.
fn pair(apart: Vector3<f64>) -> Graph {
    let text = |id: usize, at: Vector3<f64>, edges: &[usize]| {
        let parent = if id == 0 { Value::Null } else { (id - 1).into() };
        json!({"id": id, "parent": parent, "edges": edges, "radius": 4.0, "active": false,
               "coordinates": {"x": at.x, "y": at.y, "z": at.z}})
    };
    let [east, far] = [Vector3::new(10.0, 0.0, 0.0), Vector3::new(50.0, 50.0, 0.0)];
    let nodes = [
        text(0, -east, &[1]),
        text(1, east, &[2]),
        text(2, far, &[3]),
        text(3, far + apart, &[4]),
        text(4, east + apart, &[5]),
        text(5, -east + apart, &[]),
    ];
    let file = json!({"plume": "", "nodes": nodes}).to_string();
    plume::survey::json::read(&file).unwrap().graph
}

#[test]
fn the_thickness_of_rock_is_told_to_the_millimetre() {
    // Passages of 2.4 m by 2.64 m.
    for (apart, rock_m) in [
        (Vector3::new(0.0, 0.0, -6.0), 6.0 - 2.64),
        (Vector3::new(0.0, 6.0, 0.0), 6.0 - 2.4),
        (Vector3::new(0.0, 0.0, -2.0), 2.0 - 2.64),
    ] {
        let graph = pair(apart);
        let passages = [[0, 1], [4, 5]].map(|passage| passage.map(StationId::new));
        let thin = thin_rock(&graph, PassageSize::default(), 4.0);
        let found = thin.iter().find(|thin| thin.passages == passages).expect("it is thinner than 4 m");
        assert!((found.rock_m - rock_m).abs() < 1e-3, "{apart}: {}", found.rock_m);
        assert!(!thin_rock(&graph, PassageSize::default(), rock_m - 0.001).iter().any(|t| t.passages == passages));
    }
}

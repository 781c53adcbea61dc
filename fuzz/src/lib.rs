//! What the fuzzers of all readers share.

use std::io;
use std::path::{Path, PathBuf};

use plume_graph::{Graph, Outside, VERSION};
use plume_survey::{Parts, Source, format, json};

/// Between a file and those that it leads to: no UTF-8 text has it.
const NEXT_FILE: u8 = 0xff;

/// Whatever file is asked for, these bytes.
struct Other<'a>(&'a [u8]);

impl Outside for Other<'_> {
    fn read(&self, _: &Path) -> io::Result<Vec<u8>> {
        Ok(self.0.to_vec())
    }
}

/// Reads bytes with a row of the table. A graph must survive a round trip through JSON.
pub fn read(name: &str, bytes: &[u8]) {
    let row = format(name).expect("there is such a row");
    let reader = row.read.expect("it is read");
    // A .3d is bytes and leads nowhere.
    let end = bytes.iter().position(|&byte| byte == NEXT_FILE && row.name != "survex-3d").unwrap_or(bytes.len());
    let other = Other(bytes.get(end + 1..).unwrap_or_default());
    let path = PathBuf::from(format!("fuzz{}", row.endings[0]));
    for parts in [Parts::Refuse, Parts::Join, Parts::Keep, Parts::Longest] {
        let source = Source { path: &path, bytes: &bytes[..end], outside: &other };
        match reader(&source, parts) {
            Ok(import) => keeps_the_laws(&import.graph, parts),
            Err(error) => assert!(!error.message.is_empty() && !error.place.to_string().is_empty()),
        }
    }
}

/// Reads bytes as a picture or grid of heights, and lays a graph in it.
pub fn read_heights(bytes: &[u8]) {
    let row = plume_generators::GENERATORS.find("heightmap").expect("there is such a row");
    let settings = serde_json::json!({"path": "fuzz.png", "nodes": 4});
    let heightmap = (row.read)(settings).expect("these are settings");
    match heightmap.generate(7, &Other(bytes)) {
        Ok(graph) => keeps_the_laws(&graph, Parts::Refuse),
        Err(error) => assert!(!error.message.is_empty()),
    }
}

fn keeps_the_laws(graph: &Graph, parts: Parts) {
    assert!(graph.nodes.len() >= 2);
    assert!(graph.neighbors().iter().all(|others| !others.is_empty()));
    assert!(parts == Parts::Keep || graph.components().len() == 1);
    assert!(graph.nodes.iter().all(|node| node.radius > 0.0 && node.position.iter().all(|x| x.is_finite())));
    if parts != Parts::Keep {
        let back = json::read(&json::write(graph, VERSION, &serde_json::Value::Null));
        assert_eq!(&back.expect("it is a graph").graph, graph);
    }
}

//! Directed graphs as GraphML (<http://graphml.graphdrawing.org/>), as networkx, igraph, Gephi and yEd read it.
//!
//! Names and texts are written as they are: they need no escapes.

use std::fmt::Write;

/// A key of nodes or edges.
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// Whether edges have it, and not nodes.
    pub is_of_edges: bool,
    /// `int`, `double` or `string`.
    pub kind: &'static str,
}

/// A graph being written.
pub struct GraphMl(String);

impl GraphMl {
    /// A graph without nodes, of which nodes and edges have values of these keys.
    pub fn new(keys: &[Key]) -> Self {
        let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
                        <graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n"
            .to_owned();
        for Key { name, is_of_edges, kind } in keys {
            let of = if *is_of_edges { "edge" } else { "node" };
            put(
                &mut text,
                format_args!("<key id=\"{name}\" for=\"{of}\" attr.name=\"{name}\" attr.type=\"{kind}\"/>\n"),
            );
        }
        text.push_str("<graph id=\"network\" edgedefault=\"directed\">\n");
        Self(text)
    }

    /// Adds a node with its values.
    pub fn node(&mut self, id: &str, values: &[(&str, String)]) {
        put(&mut self.0, format_args!("<node id=\"{id}\">"));
        self.values(values);
        self.0.push_str("</node>\n");
    }

    /// Adds an edge with its values.
    pub fn edge(&mut self, [source, target]: [&str; 2], values: &[(&str, String)]) {
        put(&mut self.0, format_args!("<edge source=\"{source}\" target=\"{target}\">"));
        self.values(values);
        self.0.push_str("</edge>\n");
    }

    /// The file.
    pub fn finish(self) -> String {
        self.0 + "</graph>\n</graphml>\n"
    }

    fn values(&mut self, values: &[(&str, String)]) {
        for (name, value) in values {
            put(&mut self.0, format_args!("<data key=\"{name}\">{value}</data>"));
        }
    }
}

fn put(text: &mut String, part: std::fmt::Arguments) {
    text.write_fmt(part).expect("writing to a string cannot fail");
}

//! A graph compared with real caves, as a table or as JSON.

use serde_json::{Map, Value, json};

use plume_exporters::frame::milli;
use plume_graph::Graph;
use plume_graph::realism::{CORE_NEEDED, LEAST_STATIONS, Likeness, Row, SCALE_FREE, Standing, Verdict};

/// A table followed by the verdict.
pub fn text(likeness: &Likeness, graph: &Graph) -> String {
    let heading = format!(
        "{:28} {:>9} {:>11} {:>9} {:>9} {:>9} {:>9}\n",
        "among 34 real caves", "value", "percentile", "min", "10 %", "90 %", "max"
    );
    let (counted, others): (Vec<Row>, Vec<Row>) = likeness.rows().partition(|row| row.counts);
    let lines = |rows: Vec<Row>| rows.iter().map(line).collect::<String>();
    [
        format!("graph: {}\n\n", size(likeness, graph)),
        heading,
        lines(counted),
        "grow with the cave, not counted:\n".to_owned(),
        lines(others),
        sampling(likeness),
        format!("\n{}\n", verdict(likeness)),
    ]
    .concat()
}

/// The same for programs; metrics have snake-case names.
pub fn json(likeness: &Likeness, graph: &Graph) -> Value {
    let metrics: Map<String, Value> =
        likeness.rows().map(|row| (row.metric.name.replace(' ', "_"), cell(&row))).collect();
    json!({
        "stations": likeness.stations,
        "passages": graph.edges.len(),
        "parts": graph.components().len(),
        "length_m": milli(graph.length_m()),
        "branches": likeness.metrics.branches,
        "max_degree": likeness.metrics.max_degree,
        "metrics": metrics,
        "sampling": likeness.metrics.sampling,
        "verdict": likeness.verdict,
        "failing": likeness.failing(),
    })
}

/// Why the graph is not like a real cave.
pub fn complaint(likeness: &Likeness) -> String {
    let why = match likeness.verdict {
        Verdict::TooSmall => "it is too small to judge".to_owned(),
        _ => format!("see {}", likeness.failing().join(", ")),
    };
    format!("the graph is not like a real cave: {why}")
}

fn size(likeness: &Likeness, graph: &Graph) -> String {
    let parts = match graph.components().len() {
        1 => String::new(),
        parts => format!("  {parts} parts"),
    };
    format!(
        "{} stations  {} passages  {:.0} m{parts}  {} branches  at most {} passages at a station",
        likeness.stations,
        graph.edges.len(),
        graph.length_m(),
        likeness.metrics.branches,
        likeness.metrics.max_degree
    )
}

fn line(row: &Row) -> String {
    let range = row.metric.range;
    let unit = if row.metric.unit.is_empty() { String::new() } else { format!(" ({})", row.metric.unit) };
    let name = format!("{}{unit}", row.metric.name);
    let cells = [range.min, range.p10, range.p90, range.max].map(|bound| format!(" {bound:9.3}")).concat();
    format!("  {name:26} {:9.3} {:11.0}{cells}  {}\n", row.value, row.percentile, word(row.standing))
}

fn word(standing: Standing) -> &'static str {
    match standing {
        Standing::Core => "usual",
        Standing::Inside => "rare",
        Standing::Outside => "never",
    }
}

fn cell(row: &Row) -> Value {
    let range = row.metric.range;
    json!({
        "value": row.value, "unit": row.metric.unit, "percentile": row.percentile, "standing": row.standing,
        "counts": row.counts,
        "real_caves": {"min": range.min, "p10": range.p10, "median": range.median, "p90": range.p90, "max": range.max},
    })
}

fn sampling(likeness: &Likeness) -> String {
    likeness.metrics.sampling.map_or_else(String::new, |sampling| {
        format!(
            "shortest paths were counted from a sample of {} places; standard errors: average path {:.3}, central point \
             dominance {:.3}\n",
            sampling.sources, sampling.average_path_error, sampling.dominance_error
        )
    })
}

fn verdict(likeness: &Likeness) -> String {
    let realism = likeness.metrics.realism(0.0);
    let counts = format!("{} of {SCALE_FREE} metrics in their range, {} usual", realism.inside, realism.core);
    let failing = likeness.failing().join(", ");
    match likeness.verdict {
        Verdict::Real => format!("like a real cave: {counts}"),
        Verdict::Unusual => format!("unusual for a real cave: {counts}, where {CORE_NEEDED} are needed ({failing})"),
        Verdict::Unreal => format!("unlike any real cave: {counts} ({failing})"),
        Verdict::TooSmall => {
            format!("too small to judge: the statistics need {LEAST_STATIONS} stations and a junction")
        }
    }
}

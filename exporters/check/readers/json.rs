//! JSON. The keys `file` and `uri` refer to other files, in our formats as in common ones.

use serde_json::Value;

use super::{Content, Found, Unfit};
use crate::instances::INSTANCES;

/// The longest text that is parsed, which takes about ten times its size.
const MOST_BYTES: usize = 1 << 25;

/// Reads any JSON.
pub fn read(content: &mut Content<'_>, found: &mut Found) -> Result<(), Unfit> {
    let value = parse(&content.rest()?)?;
    if content.path() == INSTANCES {
        found.things(value["things"].as_array().ok_or("does not list things")?);
    }
    let mut left = vec![&value];
    while let Some(value) = left.pop() {
        match value {
            Value::Array(items) => left.extend(items),
            Value::Object(members) => {
                for (key, value) in members {
                    match value {
                        Value::String(to) if key == "file" || key == "uri" => found.reference(content.path(), to),
                        value => left.push(value),
                    }
                }
            }
            _ => {}
        }
    }
    Ok(())
}

/// Any JSON in memory.
pub fn parse(text: &[u8]) -> Result<Value, Unfit> {
    if text.len() > MOST_BYTES {
        return Err("is too large to be read into memory".into());
    }
    serde_json::from_slice(text).map_err(|error| Unfit(format!("is not valid JSON: {error}")))
}

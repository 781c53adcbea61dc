//! PLY: the header, and that the body has the length it states.

use std::io::Read;

use super::{Content, Found, Unfit};

/// Most properties of an element, and most elements of a file.
const MOST_PARTS: usize = 256;

struct Element {
    count: u64,
    properties: Vec<Property>,
}

enum Property {
    /// A number: its bytes.
    Number(u64),
    /// A list: bytes of the count, and of each number.
    List(u64, u64),
}

#[derive(Clone, Copy)]
enum Order {
    Text,
    Little,
    Big,
}

/// Reads `.ply`.
pub fn read(content: &mut Content<'_>, _: &mut Found) -> Result<(), Unfit> {
    let (order, elements) = read_head(content)?;
    for element in &elements {
        match (order, fixed_bytes(element)) {
            (Order::Text, _) => (0..element.count).try_for_each(|_| read_row(element, content))?,
            (_, Some(bytes)) => content.skip(bytes.saturating_mul(element.count))?,
            (_, None) => (0..element.count).try_for_each(|_| skip_lists(element, order, content))?,
        }
    }
    content.end()
}

fn read_head(content: &mut Content<'_>) -> Result<(Order, Vec<Element>), Unfit> {
    let mut line = || content.line()?.ok_or(Unfit::from("has no end of its header"));
    if line()? != "ply" {
        return Err("is not a PLY".into());
    }
    let (mut order, mut elements) = (None, Vec::<Element>::new());
    loop {
        let line = line()?;
        let words: Vec<&str> = line.split_whitespace().take(6).collect();
        match words[..] {
            ["format", name, "1.0"] => order = Some(order_of(name)?),
            ["comment" | "obj_info", ..] => {}
            ["element", _, count] if elements.len() < MOST_PARTS => {
                let count = count.parse().map_err(|_| Unfit::from("has an element without a count"))?;
                elements.push(Element { count, properties: Vec::new() });
            }
            ["property", ref kinds @ .., _] => add_property(elements.last_mut(), kinds)?,
            ["end_header"] => break,
            _ => return Err("has an invalid PLY header".into()),
        }
    }
    Ok((order.ok_or("does not state its format")?, elements))
}

fn order_of(name: &str) -> Result<Order, Unfit> {
    match name {
        "ascii" => Ok(Order::Text),
        "binary_little_endian" => Ok(Order::Little),
        "binary_big_endian" => Ok(Order::Big),
        _ => Err("has an unknown PLY format".into()),
    }
}

fn add_property(element: Option<&mut Element>, kinds: &[&str]) -> Result<(), Unfit> {
    let property = match *kinds {
        ["list", count, item] => bytes_of(count).zip(bytes_of(item)).map(|(count, item)| Property::List(count, item)),
        [kind] => bytes_of(kind).map(Property::Number),
        _ => None,
    };
    let fits = |element: &&mut Element| element.properties.len() < MOST_PARTS;
    let (Some(element), Some(property)) = (element.filter(fits), property) else {
        return Err("has an invalid PLY property".into());
    };
    element.properties.push(property);
    Ok(())
}

fn bytes_of(kind: &str) -> Option<u64> {
    match kind {
        "char" | "uchar" | "int8" | "uint8" => Some(1),
        "short" | "ushort" | "int16" | "uint16" => Some(2),
        "int" | "uint" | "float" | "int32" | "uint32" | "float32" => Some(4),
        "double" | "float64" => Some(8),
        _ => None,
    }
}

fn fixed_bytes(element: &Element) -> Option<u64> {
    let bytes = |property: &Property| match property {
        Property::Number(bytes) => Some(*bytes),
        Property::List(..) => None,
    };
    element.properties.iter().map(bytes).sum::<Option<u64>>()
}

fn skip_lists(element: &Element, order: Order, content: &mut Content<'_>) -> Result<(), Unfit> {
    element.properties.iter().try_for_each(|property| match *property {
        Property::Number(bytes) => content.skip(bytes),
        Property::List(count, item) => {
            let count = read_count(count, order, content)?;
            content.skip(count.saturating_mul(item))
        }
    })
}

fn read_count(bytes: u64, order: Order, content: &mut Content<'_>) -> Result<u64, Unfit> {
    let mut eight = [0; 8];
    let bytes = bytes as usize;
    content.read_exact(&mut eight[..bytes])?;
    if matches!(order, Order::Big) {
        eight[..bytes].reverse();
    }
    Ok(u64::from_le_bytes(eight))
}

fn read_row(element: &Element, content: &mut Content<'_>) -> Result<(), Unfit> {
    let line = content.line()?.ok_or(Unfit::from("ends early"))?;
    let numbers = line.split_whitespace().map(|word| word.parse::<f64>().is_ok_and(f64::is_finite));
    let count = numbers.clone().count();
    let is_row = numbers.clone().all(|is_number| is_number) && count >= element.properties.len();
    if is_row { Ok(()) } else { Err("has an invalid PLY row".into()) }
}

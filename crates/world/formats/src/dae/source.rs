//! References and arrays of numbers.

use std::collections::HashMap;
use std::path::Path;

use elbowroom_spatial::Vec3;
use roxmltree::Node;

use crate::tokens::{Tokens, number, show};
use crate::{Diagnostic, xml};

/// The element to which a `#reference` in an attribute refers.
pub(super) fn target<'a, 'i>(
    ids: &HashMap<&'a str, Node<'a, 'i>>,
    node: Node<'a, 'i>,
    attribute: &str,
    file: &Path,
) -> Result<Node<'a, 'i>, Diagnostic> {
    let name = node.tag_name().name();
    let error = |what: String| Diagnostic::new(file, xml::attribute_line(node, attribute), what);
    let url = node
        .attribute(attribute)
        .ok_or_else(|| error(format!("<{name}> has no {attribute}")).hint(format!("<{name} {attribute}=\"#ID\">")))?;
    let id = url.strip_prefix('#').ok_or_else(|| {
        error(format!("`{}` points into another file, which is not followed", show(url.as_bytes())))
            .hint(format!("{attribute}=\"#ID\" of an element in this file"))
    })?;
    ids.get(id).copied().ok_or_else(|| {
        error(format!("nothing has the id `{}`", show(id.as_bytes())))
            .hint(format!("{attribute}=\"#ID\" of an element in this file"))
    })
}

/// The points of a `<source>`: its array, read through its accessor.
pub(super) fn points(source: Node<'_, '_>, file: &Path) -> Result<Vec<Vec3>, Diagnostic> {
    let array = xml::child(source, "float_array").ok_or_else(|| {
        Diagnostic::new(file, xml::line(source), "the source has no <float_array>")
            .hint("<float_array count=\"9\">0 0 0 …</float_array>")
    })?;
    let numbers = floats(array, file)?;
    let accessor = xml::child(source, "technique_common").and_then(|t| xml::child(t, "accessor"));
    let Some(accessor) = accessor else {
        return Ok(numbers.chunks_exact(3).map(|c| Vec3::new(c[0], c[1], c[2])).collect());
    };
    let attribute = |name: &str, default: usize| match accessor.attribute(name) {
        None => Ok(default),
        Some(text) => text.trim().parse::<usize>().map_err(|_| {
            let what = format!("{name}=\"{}\" of the accessor is no count", show(text.as_bytes()));
            Diagnostic::new(file, xml::attribute_line(accessor, name), what).hint(format!("{name}=\"3\""))
        }),
    };
    let (offset, stride) = (attribute("offset", 0)?, attribute("stride", 3)?.max(1));
    let count = attribute("count", numbers.len() / stride)?;
    let [x, y, z] = coordinate_columns(accessor);
    let last = x.max(y).max(z);
    let needed =
        if count == 0 { 0 } else { (count - 1).saturating_mul(stride).saturating_add(offset).saturating_add(last + 1) };
    if needed > numbers.len() {
        let what =
            format!("the accessor promises {count} points = {needed} numbers, but the array has {}", numbers.len());
        return Err(Diagnostic::new(file, xml::line(accessor), what)
            .hint(format!("count=\"{}\", or the missing numbers", numbers.len() / stride)));
    }
    Ok((0..count).map(|i| &numbers[offset + i * stride..]).map(|p| Vec3::new(p[x], p[y], p[z])).collect())
}

/// The columns named X, Y and Z, else the first three.
fn coordinate_columns(accessor: Node<'_, '_>) -> [usize; 3] {
    let names: Vec<_> = xml::children(accessor, "param").map(|p| p.attribute("name").unwrap_or_default()).collect();
    let column = |axis: &str| names.iter().position(|n| n.eq_ignore_ascii_case(axis));
    match (column("X"), column("Y"), column("Z")) {
        (Some(x), Some(y), Some(z)) => [x, y, z],
        _ => [0, 1, 2],
    }
}

/// Reads finite numbers. Only arrays of positions are read.
fn floats(node: Node<'_, '_>, file: &Path) -> Result<Vec<f64>, Diagnostic> {
    let text = xml::text(node);
    let mut numbers = Vec::with_capacity(text.len() / 12);
    let mut words = Tokens::at_line(text.as_bytes(), 0);
    while let Some(word) = words.next() {
        match number(word) {
            Some(x) if x.is_finite() => numbers.push(x),
            other => {
                let why = if other.is_some() { "is not finite" } else { "is not a number" };
                let what = format!("`{}` {why}, as number {} of the array", show(word), numbers.len());
                return Err(Diagnostic::new(file, xml::line(node) + words.line(), what)
                    .hint("a finite decimal number such as 0.25"));
            }
        }
    }
    Ok(numbers)
}

/// Reads non-negative integers: indices and counts.
pub(super) fn indices(node: Node<'_, '_>, file: &Path) -> Result<Vec<u32>, Diagnostic> {
    let text = xml::text(node);
    let mut numbers = Vec::with_capacity(text.len() / 6);
    let mut words = Tokens::at_line(text.as_bytes(), 0);
    while let Some(word) = words.next() {
        let index = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        numbers.push(index.ok_or_else(|| {
            let what = format!("`{}` in <{}> is not a whole number from 0", show(word), node.tag_name().name());
            Diagnostic::new(file, xml::line(node) + words.line(), what).hint("0, 1, 2, …")
        })?);
    }
    Ok(numbers)
}

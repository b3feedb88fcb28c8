//! A plot as plotly.js reads it: its attributes are documented at <https://plotly.com/javascript/reference/>.

use serde_json::{Value, json};

/// Traces and layout.
#[derive(Debug, Clone, Default)]
pub struct Plot {
    /// The traces; later ones are drawn on top.
    pub traces: Vec<Value>,
    /// The layout.
    pub layout: Value,
}

impl Plot {
    /// A plot with this layout and no trace.
    pub fn new(layout: Value) -> Self {
        Self { traces: Vec::new(), layout }
    }

    /// Adds a trace on top.
    pub fn add(&mut self, trace: Value) {
        self.traces.push(trace);
    }
}

/// Sets attributes: attributes of `more` replace attributes of `base`, object by object.
pub fn with(base: Value, more: Value) -> Value {
    match (base, more) {
        (Value::Object(mut fields), Value::Object(more)) => {
            for (name, value) in more {
                let merged = with(fields.remove(&name).unwrap_or_default(), value);
                fields.insert(name, merged);
            }
            Value::Object(fields)
        }
        (_, more) => more,
    }
}

/// A curve through points; a `None` interrupts it.
pub fn line(x: Vec<Option<f64>>, y: Vec<Option<f64>>, name: &str, style: Value) -> Value {
    scatter([("x", x.into()), ("y", y.into()), ("name", name.into()), ("mode", "lines".into()), ("line", style)])
}

/// Points without a curve.
pub fn markers(x: Vec<Option<f64>>, y: Vec<Option<f64>>, name: &str, style: Value) -> Value {
    scatter([("x", x.into()), ("y", y.into()), ("name", name.into()), ("mode", "markers".into()), ("marker", style)])
}

fn scatter(attributes: [(&str, Value); 5]) -> Value {
    [("type", "scatter".into()), ("connectgaps", false.into())].into_iter().chain(attributes).collect()
}

/// Colour and width (pixels) of a line.
pub fn stroke(color: &str, width: f64) -> Value {
    json!({ "color": color, "width": width })
}

/// An axis with a title.
pub fn axis(title: &str) -> Value {
    json!({ "title": { "text": title }, "automargin": true, "zeroline": false })
}

/// Layout with the legend above, and hover on the nearest point.
pub fn layout(x_axis: Value, y_axis: Value) -> Value {
    let frame = json!({
        "margin": { "l": 60, "r": 16, "t": 40, "b": 48 },
        "hovermode": "closest",
        "legend": { "orientation": "h", "x": 0.0, "y": 1.02, "yanchor": "bottom" },
    });
    with(frame, [("xaxis", x_axis), ("yaxis", y_axis)].into_iter().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_are_merged_object_by_object() {
        let base = json!({ "title": { "text": "a", "x": 1 }, "range": [0, 1] });
        let merged = with(base, json!({ "title": { "text": "b" }, "range": [2] }));
        assert_eq!(merged, json!({ "title": { "text": "b", "x": 1 }, "range": [2] }));
    }
}

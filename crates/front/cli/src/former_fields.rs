//! JSON fields that were renamed are also written under their former name, for one version.

use serde_json::{Map, Value};

/// The present name and the former one.
const RENAMED: [(&str, &str); 3] =
    [("suspect_units", "unit_doubts"), ("non_manifold_edges", "crowded_edges"), ("off_path_s", "astray_s")];

/// Adds the former names at every depth of a document.
pub(crate) fn add(document: &mut Value) {
    match document {
        Value::Array(items) => items.iter_mut().for_each(add),
        Value::Object(fields) => {
            fields.values_mut().for_each(add);
            add_to(fields);
        }
        _ => {}
    }
}

fn add_to(fields: &mut Map<String, Value>) {
    for (name, former) in RENAMED {
        if let Some(value) = fields.get(name).cloned() {
            fields.insert(former.to_owned(), value);
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn renamed_fields_keep_their_former_name() {
        let mut document = json!({ "robots": [{ "avoidance": { "off_path_s": 0.5 } }], "suspect_units": [] });
        add(&mut document);
        assert_eq!(document["robots"][0]["avoidance"]["astray_s"], 0.5);
        assert_eq!(document["unit_doubts"], json!([]));
        assert_eq!(document["crowded_edges"], Value::Null);
    }
}

//! Data blocks of a page of the report.
#![allow(dead_code, reason = "every test program uses a part of it")]

use std::io::Read as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::read::DeflateDecoder;
use serde_json::Value;

/// A block of the page with this id, inflated.
pub fn inflated(html: &str, id: &str) -> String {
    let open = format!("<script type=\"text/plain\" id=\"{id}\">");
    let from = html.find(&open).unwrap() + open.len();
    let to = from + html[from..].find("</script>").unwrap();
    let mut text = String::new();
    let bytes = STANDARD.decode(&html[from..to]).unwrap();
    DeflateDecoder::new(&bytes[..]).read_to_string(&mut text).unwrap();
    text
}

/// The JSON block with this id.
pub fn block(html: &str, id: &str) -> Value {
    serde_json::from_str(&inflated(html, id)).unwrap()
}

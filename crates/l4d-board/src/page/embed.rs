//! How data travels inside an HTML file: as JSON that cannot end its element, or as packed text that is unpacked when
//! it is looked at.

use std::io::BufWriter;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde::Serialize;
use serde_json::Value;

/// JSON for an element that is no markup: `<`, `>` and `&` are written as escapes of JSON, so that nothing in a name
/// or a sentence can end the element or begin another.
pub(crate) fn json(value: &Value) -> String {
    let mut safe = String::new();
    for letter in value.to_string().chars() {
        match letter {
            '<' => safe.push_str("\\u003c"),
            '>' => safe.push_str("\\u003e"),
            '&' => safe.push_str("\\u0026"),
            '\u{2028}' => safe.push_str("\\u2028"),
            '\u{2029}' => safe.push_str("\\u2029"),
            other => safe.push(other),
        }
    }
    safe
}

/// JSON as zlib (RFC 1950) in base64, which `DecompressionStream("deflate")` of a browser reads.
pub(crate) fn packed(value: &impl Serialize) -> std::io::Result<String> {
    let mut writer = BufWriter::new(ZlibEncoder::new(Vec::new(), Compression::default()));
    serde_json::to_writer(&mut writer, value)?;
    Ok(base64(&writer.into_inner()?.finish()?))
}

/// Standard base64 with padding.
pub(crate) fn base64(bytes: &[u8]) -> String {
    STANDARD.encode(bytes)
}

/// Text between tags or in a quoted attribute.
pub(crate) fn html(text: &str) -> String {
    let mut safe = String::new();
    for letter in text.chars() {
        match letter {
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '&' => safe.push_str("&amp;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            control if control.is_control() => safe.push(' '),
            other => safe.push(other),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use flate2::read::ZlibDecoder;
    use serde_json::json;

    use super::*;

    const HOSTILE: &str = "</script><script>alert(1)</script><!-- & \u{2028} \" ' \\ ]]>";

    #[test]
    fn json_holds_no_markup_and_reads_back_the_same() {
        let value = json!({ "text": HOSTILE, HOSTILE: [1, null] });
        let text = json(&value);
        assert!(!text.contains(['<', '>', '&', '\u{2028}']), "{text}");
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
    }

    #[test]
    fn packed_text_is_of_base64_alone_and_unpacks_to_the_same() {
        let value = json!({ "text": HOSTILE.repeat(100) });
        let text = packed(&value).unwrap();
        assert!(text.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"+/=".contains(&byte)));
        assert!(text.len() < HOSTILE.len() * 10, "{}", text.len());
        let mut unpacked = String::new();
        let bytes = STANDARD.decode(&text).unwrap();
        ZlibDecoder::new(bytes.as_slice()).read_to_string(&mut unpacked).unwrap();
        assert_eq!(serde_json::from_str::<Value>(&unpacked).unwrap(), value);
        assert_eq!(packed(&value).unwrap(), text);
    }

    #[test]
    fn html_text_begins_no_tag_and_ends_no_attribute() {
        assert_eq!(html("<b a=\"1\" c='2'>&\n"), "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp; ");
    }
}

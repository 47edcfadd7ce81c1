//! How data travels inside an HTML file: as JSON that cannot end its element, or as packed text that is unpacked when
//! it is looked at.

use std::io::{self, BufWriter, Write};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde::Serialize;

/// Writes JSON for an element that is no markup: `<`, `>` and `&` are written as escapes of JSON, so that nothing in a
/// name or a sentence can end the element or begin another.
pub(crate) fn json(value: &impl Serialize, out: &mut impl Write) -> io::Result<()> {
    Ok(serde_json::to_writer(Escaping(out), value)?)
}

/// Passes on JSON without markup. It is given whole letters at a time, as `serde_json` writes them.
struct Escaping<'a, W: Write>(&'a mut W);

impl<W: Write> Write for Escaping<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let text = std::str::from_utf8(bytes).map_err(io::Error::other)?;
        let mut rest = text;
        while let Some(at) = rest.find(['<', '>', '&', '\u{2028}', '\u{2029}']) {
            let (before, after) = rest.split_at(at);
            let letter = after.chars().next().unwrap_or_default();
            write!(self.0, "{before}\\u{:04x}", u32::from(letter))?;
            rest = &after[letter.len_utf8()..];
        }
        self.0.write_all(rest.as_bytes())?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
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
    use serde_json::{Value, json as value};

    use super::*;

    const HOSTILE: &str = "</script><script>alert(1)</script><!-- & \u{2028} \" ' \\ ]]>";

    #[test]
    fn json_holds_no_markup_and_reads_back_the_same() {
        let value = value!({ "text": HOSTILE, HOSTILE: [1, null] });
        let mut text = Vec::new();
        json(&value, &mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        assert!(!text.contains(['<', '>', '&', '\u{2028}']), "{text}");
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
    }

    #[test]
    fn packed_text_is_of_base64_alone_and_unpacks_to_the_same() {
        let value = value!({ "text": HOSTILE.repeat(100) });
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

//! One HTML file that needs no network: a template with its style, its scripts, a JSON document and blocks of bytes.
//!
//! Knows nothing of what a page shows.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

/// What a page is made of. The template has the marks `{{title}}`, `{{style}}`, `{{script}}` and `{{data}}`.
#[derive(Debug, Clone, Copy)]
pub struct Page<'a> {
    pub template: &'a str,
    pub title: &'a str,
    pub style: &'a str,
    /// In the order in which they build on each other.
    pub scripts: &'a [&'a str],
}

impl Page<'_> {
    /// The file. Scripts find the document as JSON in the element `document`, and each block as base64 in the element
    /// `block-<name>`. Nothing in the data can end the element that holds it: `<` is escaped, and base64 has none.
    ///
    /// # Errors
    /// A document that is no JSON.
    pub fn bytes(
        &self,
        document: &impl Serialize,
        blocks: &[(String, Vec<u8>)],
    ) -> Result<Vec<u8>, serde_json::Error> {
        let mut html = String::new();
        let mut rest = self.template;
        while let Some((before, after)) = rest.split_once("{{") {
            let (mark, after) = after.split_once("}}").unwrap_or((after, ""));
            html.push_str(before);
            match mark {
                "title" => html.push_str(&escaped(self.title)),
                "style" => html.push_str(self.style),
                "script" => self.scripts.iter().for_each(|script| html.push_str(script)),
                _ => push_data(&mut html, document, blocks)?,
            }
            rest = after;
        }
        html.push_str(rest);
        Ok(html.into_bytes())
    }
}

fn push_data(
    html: &mut String,
    document: &impl Serialize,
    blocks: &[(String, Vec<u8>)],
) -> Result<(), serde_json::Error> {
    let json = serde_json::to_string(document)?.replace('<', "\\u003c");
    html.push_str(&format!("<script type=\"application/json\" id=\"document\">{json}</script>\n"));
    for (name, bytes) in blocks {
        html.push_str(&format!("<script type=\"text/plain\" id=\"block-{name}\">"));
        STANDARD.encode_string(bytes, html);
        html.push_str("</script>\n");
    }
    Ok(())
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_cannot_end_its_element_and_marks_in_data_stay() {
        let page = Page {
            template: "<title>{{title}}</title>{{style}}{{data}}<script>{{script}}</script>",
            title: "a<b & c",
            style: "p{}",
            scripts: &["one;", "two;"],
        };
        let document = ["</script><script>evil()", "{{title}}"];
        let bytes = page.bytes(&document, &[("x".to_owned(), vec![0, 255])]).unwrap();
        insta::assert_snapshot!(String::from_utf8(bytes).unwrap(), @r#"
        <title>a&lt;b &amp; c</title>p{}<script type="application/json" id="document">["\u003c/script>\u003cscript>evil()","{{title}}"]</script>
        <script type="text/plain" id="block-x">AP8=</script>
        <script>one;two;</script>
        "#);
    }
}

//! The HTML file: style, script and data in one, and a policy that lets it run nothing else and reach no network.

use std::io::{self, Write};

use l4d_data::digest::sha256;
use serde::Serialize;

use super::embed::{base64, html, json};

const SHELL: &str = include_str!("../../assets/page/page.html");
const STYLE: &str = include_str!("../../assets/page/page.css");
/// In the order in which one uses the other.
const SCRIPTS: [&str; 15] = [
    include_str!("../../assets/page/dom.js"),
    include_str!("../../assets/page/store.js"),
    include_str!("../../assets/page/address.js"),
    include_str!("../../assets/page/csv.js"),
    include_str!("../../assets/page/tips.js"),
    include_str!("../../assets/page/rle.js"),
    include_str!("../../assets/page/overlay.js"),
    include_str!("../../assets/page/chart.js"),
    include_str!("../../assets/page/table.js"),
    include_str!("../../assets/page/board.js"),
    include_str!("../../assets/page/method.js"),
    include_str!("../../assets/page/query.js"),
    include_str!("../../assets/page/protocol.js"),
    include_str!("../../assets/page/compare.js"),
    include_str!("../../assets/page/main.js"),
];

/// The document while it is written: its head, elements that hold data, its end.
pub(crate) struct Page<W: Write> {
    out: W,
}

impl<W: Write> Page<W> {
    /// Writes everything before the data.
    pub(crate) fn begin(mut out: W, title: &str) -> io::Result<Self> {
        let policy = format!(
            "default-src 'none'; script-src 'sha256-{}'; style-src 'sha256-{}'; img-src data: blob:; \
             base-uri 'none'; form-action 'none'",
            base64(&sha256(SCRIPTS.concat().as_bytes())),
            base64(&sha256(STYLE.as_bytes())),
        );
        let (head, _) = around_data();
        fill(&mut out, head, &[("{{policy}}", &policy), ("{{title}}", &html(title)), ("{{style}}", STYLE)])?;
        Ok(Self { out })
    }

    /// Writes a value that the page knows when it opens.
    pub(crate) fn json(&mut self, id: &str, value: &impl Serialize) -> io::Result<()> {
        self.element(id, "application/json", |out| json(value, out))
    }

    /// Writes text without markup.
    pub(crate) fn text(&mut self, id: &str, text: &str) -> io::Result<()> {
        self.element(id, "text/plain", |out| out.write_all(text.as_bytes()))
    }

    fn element(
        &mut self,
        id: &str,
        kind: &str,
        content: impl FnOnce(&mut W) -> io::Result<()>,
    ) -> io::Result<()> {
        write!(self.out, "<script type=\"{kind}\" id=\"{id}\">")?;
        content(&mut self.out)?;
        self.out.write_all(b"</script>\n")
    }

    /// Writes everything behind the data.
    pub(crate) fn end(mut self) -> io::Result<()> {
        let (_, foot) = around_data();
        fill(&mut self.out, foot, &[("{{script}}", &SCRIPTS.concat())])
    }
}

/// The shell before and behind the mark for data.
fn around_data() -> (&'static str, &'static str) {
    SHELL.split_once("{{data}}").expect("the shell holds the mark for data")
}

/// Writes a part of the shell. Each mark is in it once, and what replaces it is never searched again.
fn fill(out: &mut impl Write, mut shell: &str, parts: &[(&str, &str)]) -> io::Result<()> {
    for (mark, content) in parts {
        let (before, after) = shell.split_once(mark).expect("the shell holds every mark, in this order");
        out.write_all(before.as_bytes())?;
        out.write_all(content.as_bytes())?;
        shell = after;
    }
    out.write_all(shell.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn document(title: &str, write: impl FnOnce(&mut Page<&mut Vec<u8>>) -> io::Result<()>) -> String {
        let mut bytes = Vec::new();
        let mut page = Page::begin(&mut bytes, title).unwrap();
        write(&mut page).unwrap();
        page.end().unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn the_page_names_no_address_and_ends_its_script_once() {
        let page = document("A & <b>", |page| page.json("x", &serde_json::json!({})));
        assert!(page.starts_with("<!doctype html>"));
        assert!(page.contains("<title>A &amp; &lt;b&gt;</title>"));
        assert!(!page.contains("{{"), "a mark is left");
        for reached in ["http://", "https://", "src=", "@import", "url("] {
            let found = page.match_indices(reached).map(|(at, _)| &page[at..(at + 40).min(page.len())]);
            let found: Vec<&str> =
                found.filter(|text| !text.starts_with("http://www.w3.org/2000/svg")).collect();
            assert!(found.is_empty(), "{found:?}");
        }
        assert_eq!(page.matches("</script>").count(), 2);
        assert_eq!(page.matches("</style>").count(), 1);
    }

    #[test]
    fn data_that_looks_like_a_mark_stays_data() {
        let page = document("{{style}}", |page| page.text("x", "{{script}}"));
        assert!(page.contains("<title>{{style}}</title>") && page.contains(">{{script}}</script>"));
    }
}

//! The HTML file: style, script and data in one, and a policy that lets it run nothing else and reach no network.

use l4d_data::digest::sha256;

use super::embed::{base64, html};

const SHELL: &str = include_str!("../../assets/page/page.html");
const STYLE: &str = include_str!("../../assets/page/page.css");
/// In the order in which one uses the other.
const SCRIPTS: [&str; 13] = [
    include_str!("../../assets/page/dom.js"),
    include_str!("../../assets/page/store.js"),
    include_str!("../../assets/page/address.js"),
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

/// The document; `data` are (id, content type, content) of elements that hold data, whose content is safe already.
pub(crate) fn document(title: &str, data: &[(String, &str, String)]) -> String {
    let script = SCRIPTS.concat();
    let policy = format!(
        "default-src 'none'; script-src 'sha256-{}'; style-src 'sha256-{}'; img-src data: blob:; \
         base-uri 'none'; form-action 'none'",
        base64(&sha256(script.as_bytes())),
        base64(&sha256(STYLE.as_bytes())),
    );
    let elements: Vec<String> = data
        .iter()
        .map(|(id, kind, content)| format!("<script type=\"{kind}\" id=\"{id}\">{content}</script>\n"))
        .collect();
    // Each mark is in the shell once, and what replaces it is never searched again.
    let parts: [(&str, &str); 5] = [
        ("{{policy}}", &policy),
        ("{{title}}", &html(title)),
        ("{{style}}", STYLE),
        ("{{data}}", &elements.concat()),
        ("{{script}}", &script),
    ];
    let mut page = String::new();
    let mut rest = SHELL;
    for (mark, content) in parts {
        let (before, after) = rest.split_once(mark).expect("the shell holds every mark, in this order");
        page.push_str(before);
        page.push_str(content);
        rest = after;
    }
    page.push_str(rest);
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_names_no_address_and_ends_its_script_once() {
        let page = document("A & <b>", &[("x".to_owned(), "application/json", "{}".to_owned())]);
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
        let page = document("{{style}}", &[("x".to_owned(), "text/plain", "{{script}}".to_owned())]);
        assert!(page.contains("<title>{{style}}</title>") && page.contains(">{{script}}</script>"));
    }
}

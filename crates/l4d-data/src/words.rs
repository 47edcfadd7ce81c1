//! Numbers with their nouns.

/// `1 scene`, `2 scenes`, `1 query`, `0 queries`.
pub fn counted(count: usize, noun: &str) -> String {
    let plural = match noun.strip_suffix('y') {
        Some(stem) => format!("{stem}ies"),
        None => format!("{noun}s"),
    };
    if count == 1 { format!("1 {noun}") } else { format!("{count} {plural}") }
}

#[cfg(test)]
mod tests {
    use super::counted;

    #[test]
    fn one_is_one() {
        assert_eq!(
            [counted(1, "scene"), counted(2, "scene"), counted(0, "query"), counted(1, "query")],
            ["1 scene", "2 scenes", "0 queries", "1 query"]
        );
    }
}

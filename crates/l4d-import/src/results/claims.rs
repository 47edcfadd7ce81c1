//! Numbers that a method's own evaluation wrote: logs of LangSplat and 4D LangSplat, and the CSV of the latter.
//!
//! They are taken as claims: they stand in `method.json` (`reported`), are shown beside what is counted here, and never become a score. The
//! cells of the CSV are how torch prints numbers, four decimals of them, so a mean of cells is not the mean that was
//! written beside them.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::store::read_bounded;
use l4d_data::{DataError, error::inert};

/// No log is larger.
const MAX_BYTES: u64 = 64 << 20;
/// Claims of one file; a log of all scenes has hundreds.
const MOST: usize = 10_000;

/// Claimed numbers by name.
pub type Claims = BTreeMap<String, f64>;

/// Reads the claims of a log or CSV. What is no number (`NA`, `tensor(nan)`) is no claim.
///
/// # Errors
/// Files that cannot be read, and a CSV that is none of 4D LangSplat's.
pub fn read(path: &Path) -> Result<Claims, DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let text = String::from_utf8_lossy(&bytes);
    let is_table = path.extension().is_some_and(|extension| extension == "csv");
    let claims = if is_table { table(path, &text)? } else { log(&text) };
    Ok(claims.into_iter().take(MOST).collect())
}

/// What stands before a number in a line of a log, and what the number is called.
const MARKS: [(&str, &str); 6] = [
    ("trunc thresh: ", "threshold"),
    ("iou chosen: ", "iou chosen"),
    ("Localization accuracy: ", "localization accuracy"),
    ("Mean IoU: ", "mean iou"),
    ("Average vIoU: ", "viou"),
    ("Average Accuracy: ", "accuracy"),
];

fn log(text: &str) -> Claims {
    let mut claims = Claims::new();
    for line in text.lines() {
        // Two lines of averages differ in the word at their start alone.
        let kind = ["Video: ", "Clip: "].into_iter().find(|kind| line.contains(kind));
        for (mark, name) in MARKS {
            let Some(value) = after(line, mark) else { continue };
            let name = match kind {
                Some(kind) if name == "viou" || name == "accuracy" => {
                    format!("{}{name}", kind.to_lowercase())
                }
                _ => name.to_owned(),
            };
            claims.insert(name, value);
        }
        if let Some((_, rest)) = line.split_once("key:")
            && let Some((prompt, _)) = rest.split_once(", mean_iou:")
            && let Some(value) = after(line, "mean_iou:")
        {
            claims.insert(format!("iou of {}", inert(prompt)), value);
        }
    }
    claims
}

fn after(line: &str, mark: &str) -> Option<f64> {
    let (_, rest) = line.split_once(mark)?;
    let end = rest
        .find(|character: char| !matches!(character, '0'..='9' | '.' | '-' | '+' | 'e'))
        .unwrap_or(rest.len());
    number(rest[..end].trim_end_matches('.'))
}

/// `time-agnostic_results.csv`, or a table of one sentence over time.
fn table(path: &Path, text: &str) -> Result<Claims, DataError> {
    let fault = |message: &str| {
        DataError::invalid(
            path,
            "header",
            message,
            "give time-agnostic_results.csv or video-query-results-<sentence>.csv",
        )
    };
    let mut rows = records(text).into_iter();
    let header = rows.next().unwrap_or_default();
    let frames: Vec<(usize, &String)> = header
        .iter()
        .enumerate()
        .filter(|(_, name)| name.starts_with("frame_") && name.ends_with("_iou"))
        .collect();
    let mut claims = Claims::new();
    let is_of_time = match header.first().map(String::as_str) {
        Some("Prompt") => false,
        Some("Type") => true,
        _ => return Err(fault("is none of 4D LangSplat's tables")),
    };
    for row in rows {
        let Some(name) = row.first().map(|name| inert(name)) else { continue };
        if !is_of_time && let Some(value) = row.get(1).and_then(|cell| number(cell)) {
            claims.insert(format!("iou of {name}"), value);
        }
        for &(column, frame) in &frames {
            if let Some(value) = row.get(column).and_then(|cell| number(cell)) {
                claims.insert(format!("{name}, {}", inert(frame)), value);
            }
        }
    }
    Ok(claims)
}

/// A number as Python or torch prints it: `0.5`, `tensor(0.1235)`, `tensor(0.1235, device='cuda:0')`.
fn number(cell: &str) -> Option<f64> {
    let cell = cell.trim();
    let inner = cell.strip_prefix("tensor(").and_then(|rest| rest.strip_suffix(')')).unwrap_or(cell);
    let value = inner.split(',').next().unwrap_or(inner).trim();
    value.parse::<f64>().ok().filter(|value| value.is_finite())
}

/// Records of a CSV: quoted cells may hold commas, doubled quotes and line ends.
fn records(text: &str) -> Vec<Vec<String>> {
    let (mut records, mut record, mut cell) = (Vec::new(), Vec::new(), String::new());
    let mut characters = text.chars().peekable();
    let mut is_quoted = false;
    while let Some(character) = characters.next() {
        match character {
            '"' if is_quoted && characters.peek() == Some(&'"') => {
                characters.next();
                cell.push('"');
            }
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => record.push(std::mem::take(&mut cell)),
            '\n' if !is_quoted => {
                record.push(std::mem::take(&mut cell));
                records.push(std::mem::take(&mut record));
            }
            '\r' if !is_quoted => {}
            other => cell.push(other),
        }
    }
    if !cell.is_empty() || !record.is_empty() {
        record.push(cell);
        records.push(record);
    }
    records
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_of_langsplat() {
        let text = "2024-01-01 12:00:00,000 - trunc thresh: 0.4\n... iou chosen: 0.6512\n... chosen_lvl: \n[0, 2]\n\
                    Localization accuracy: 0.8475.\n";
        let claims = log(text);
        assert_eq!(claims["threshold"], 0.4);
        assert_eq!(claims["iou chosen"], 0.6512);
        assert_eq!(claims["localization accuracy"], 0.8475);
        assert_eq!(claims.len(), 3);
    }

    #[test]
    fn a_log_of_4d_langsplat() {
        let text = "key:red cup, mean_iou:0.5\nkey:plate, of china, mean_iou:0.25\nMean IoU: 0.375\n\
                    Video: Average vIoU: 0.66, Average Accuracy: 0.89\nClip: Average vIoU: 0.1, Average Accuracy: nan\n";
        let claims = log(text);
        assert_eq!((claims["iou of red cup"], claims["iou of plate, of china"]), (0.5, 0.25));
        assert_eq!(
            (claims["mean iou"], claims["video: viou"], claims["video: accuracy"]),
            (0.375, 0.66, 0.89)
        );
        assert_eq!((claims["clip: viou"], claims.get("clip: accuracy")), (0.1, None));
    }

    #[test]
    fn a_table_of_torch_s_numbers() {
        let text = "Prompt,Mean IoU,Lvls,Similarity,frame_1_iou,frame_5_iou\r\n\
                    red cup,0.51234,\"[array(1), array(0)]\",\"[array([0.1, 0.2],\n dtype=float32)]\",\"tensor(0.1235, device='cuda:0')\",NA\r\n\
                    \"a \"\"plate\"\"\",tensor(nan),[],[],tensor(0.5000),tensor(nan)\r\n";
        let claims = table(Path::new("x.csv"), text).unwrap();
        assert_eq!(claims["iou of red cup"], 0.51234);
        assert_eq!(claims["red cup, frame_1_iou"], 0.1235);
        assert_eq!(claims["a \"plate\", frame_1_iou"], 0.5);
        assert_eq!(claims.len(), 3);
        assert!(table(Path::new("x.csv"), "a,b\n1,2\n").is_err());
    }
}

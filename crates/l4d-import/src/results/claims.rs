//! Numbers that a method's own evaluation wrote, from the logs of LangSplat and 4D LangSplat.
//!
//! They are claims: they go into `method.json` (`reported`) beside what is counted here, and never become a score.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::store::read_bounded;
use l4d_data::{DataError, error::inert};

/// Largest log that is read.
const MAX_BYTES: u64 = 64 << 20;
/// Most claims of one file; a log of all scenes has hundreds.
const MAX_CLAIMS: usize = 10_000;

/// Claimed numbers by name.
pub(super) type Claims = BTreeMap<String, f64>;

/// Begins the name of a prompt's mean IoU; the prompt follows.
pub(super) const IOU_OF: &str = "iou of ";

/// Reads the claims of a log; those that are `nan` or infinite are left out.
pub(super) fn read(path: &Path) -> Result<Claims, DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let text = String::from_utf8_lossy(&bytes);
    Ok(parse(&text).into_iter().take(MAX_CLAIMS).collect())
}

/// The label before a number in a line of a log, and the name of the claim.
const LABELS: [(&str, &str); 6] = [
    ("trunc thresh: ", "threshold"),
    ("iou chosen: ", "iou chosen"),
    ("Localization accuracy: ", "localization accuracy"),
    ("Mean IoU: ", "mean iou"),
    ("Average vIoU: ", "viou"),
    ("Average Accuracy: ", "accuracy"),
];

fn parse(text: &str) -> Claims {
    let mut claims = Claims::new();
    for line in text.lines() {
        // 4D LangSplat writes the same labels twice; only the start of the line says which average it is.
        let kind = ["Video: ", "Clip: "].into_iter().find(|kind| line.contains(kind));
        for (label, name) in LABELS {
            let Some(value) = number_after(line, label) else { continue };
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
            && let Some(value) = number_after(line, "mean_iou:")
        {
            claims.insert(format!("{IOU_OF}{}", inert(prompt)), value);
        }
    }
    claims
}

fn number_after(line: &str, label: &str) -> Option<f64> {
    let (_, rest) = line.split_once(label)?;
    let end = rest
        .find(|character: char| !matches!(character, '0'..='9' | '.' | '-' | '+' | 'e'))
        .unwrap_or(rest.len());
    rest[..end].trim_end_matches('.').parse().ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_of_langsplat_is_read() {
        let text = "2024-01-01 12:00:00,000 - trunc thresh: 0.4\n... iou chosen: 0.6512\n... chosen_lvl: \n[0, 2]\n\
                    Localization accuracy: 0.8475.\n";
        let claims = parse(text);
        assert_eq!(claims["threshold"], 0.4);
        assert_eq!(claims["iou chosen"], 0.6512);
        assert_eq!(claims["localization accuracy"], 0.8475);
        assert_eq!(claims.len(), 3);
    }

    #[test]
    fn a_log_of_4d_langsplat_is_read_without_what_is_no_number() {
        let text = "key:red cup, mean_iou:0.5\nkey:plate, of china, mean_iou:0.25\nMean IoU: 0.375\n\
                    Video: Average vIoU: 0.66, Average Accuracy: 0.89\nClip: Average vIoU: 0.1, Average Accuracy: nan\n";
        let claims = parse(text);
        assert_eq!((claims["iou of red cup"], claims["iou of plate, of china"]), (0.5, 0.25));
        assert_eq!(
            (claims["mean iou"], claims["video: viou"], claims["video: accuracy"]),
            (0.375, 0.66, 0.89)
        );
        assert_eq!((claims["clip: viou"], claims.get("clip: accuracy")), (0.1, None));
    }
}

//! Voting without this program: a page that an annotator opens in a browser, and the ballot that it saves.
//!
//! [`page`] packs what the terminal would show of a round to one annotator: prompts, pictures, and numbers drawn by lot.
//! Names of objects stay out. [`SavedBallot`] turns the acts that the page saved into the log that the terminal would have
//! written of them.

mod import;

use std::collections::BTreeMap;

use l4d_data::digest::{sha256_file, sha256_hex};
use l4d_data::{DataError, Name, Progress, StageError, html};
use l4d_frames::overlay::encode_jpeg;
use l4d_votes::Round;
use serde::Serialize;

use crate::decoder::Decoder;
use crate::scene::{SceneInfo, Scenes};

pub use import::{Imported, SavedBallot};

/// No page is larger, bytes: browsers hold all of it in memory.
pub const LARGEST_PAGE: usize = 300_000_000;
const SCHEMA: &str = "l4d/vote-pack/1";
const PROGRAM: &str = concat!("l4d ", env!("CARGO_PKG_VERSION"));
/// Numbers are written as one byte, and 0 means that no object is there.
const MOST_OBJECTS: usize = 255;

/// What the page knows.
#[derive(Debug, Serialize)]
struct Document {
    schema: &'static str,
    program: &'static str,
    round: Name,
    annotator: Name,
    round_sha256: String,
    pack: String,
    items: Vec<Asked>,
    scenes: BTreeMap<Name, Shown>,
}

/// An item, in the order in which the annotator is asked.
#[derive(Debug, Serialize)]
struct Asked {
    item: String,
    scene: Name,
    text: String,
}

/// A scene, without the names of its objects.
#[derive(Debug, Serialize)]
struct Shown {
    size: [u32; 2],
    views: Vec<Name>,
    frames: Vec<u32>,
    opening: usize,
    frames_per_second: Option<f64>,
    is_capture: bool,
    /// How many numbers there are, from 1.
    objects: usize,
    /// Of each view the bytes of picture and ids of each frame, which follow each other in its block.
    lengths: BTreeMap<Name, Vec<[usize; 2]>>,
}

/// The page with which an annotator votes in a browser.
///
/// # Errors
/// Frames that cannot be read, more than 255 objects in a scene, and a page above [`LARGEST_PAGE`].
pub fn page(
    round: &Round,
    annotator: &Name,
    scenes: &Scenes,
    data: &std::path::Path,
    progress: &dyn Progress,
) -> Result<Vec<u8>, StageError> {
    let pictures = |card: &SceneInfo| card.views.len() * card.frames.len();
    progress.start("pictures", scenes.values().map(pictures).sum::<usize>() as u64);
    let mut decoder = Decoder::new(data);
    let mut shown = BTreeMap::new();
    let mut blocks = Vec::new();
    let mut bytes = 0;
    for (name, card) in scenes {
        if card.objects.len() > MOST_OBJECTS {
            let message =
                format!("{name} has {} objects, but a page numbers {MOST_OBJECTS}", card.objects.len());
            return Err(StageError::new(message, "vote about it in the terminal"));
        }
        let mut lengths = BTreeMap::new();
        for view in &card.views {
            let (block, of_frames) = block(&mut decoder, name, card, view, progress)?;
            bytes += block.len() * 4 / 3;
            if bytes > LARGEST_PAGE {
                let message = format!("the page would have more than {LARGEST_PAGE} bytes");
                return Err(StageError::new(
                    message,
                    "open a round of fewer scenes, views, or a smaller profile",
                ));
            }
            blocks.push((format!("{name}-{view}"), block));
            lengths.insert(view.clone(), of_frames);
        }
        shown.insert(name.clone(), of_card(card, lengths));
    }
    progress.finish();
    let round_sha256 = digest_of(round)?;
    let document = Document {
        schema: SCHEMA,
        program: PROGRAM,
        round: round.name.clone(),
        annotator: annotator.clone(),
        pack: pack_digest(&round_sha256, annotator),
        round_sha256,
        items: asked(round, annotator),
        scenes: shown,
    };
    let title = format!("{} - {annotator}", round.name);
    let page = html::Page { template: TEMPLATE, title: &title, style: STYLE, scripts: &SCRIPTS };
    Ok(page.bytes(&document, &blocks)?)
}

const TEMPLATE: &str = include_str!("../page/index.html");
const STYLE: &str = include_str!("../page/style.css");
/// In the order in which they build on each other.
const SCRIPTS: [&str; 14] = [
    include_str!("../page/pack.js"),
    include_str!("../page/digests.js"),
    include_str!("../page/ballot.js"),
    include_str!("../page/pictures.js"),
    include_str!("../page/model.js"),
    include_str!("../page/answers.js"),
    include_str!("../page/keeping.js"),
    include_str!("../page/looking.js"),
    include_str!("../page/drawing.js"),
    include_str!("../page/page.js"),
    include_str!("../page/dialogs.js"),
    include_str!("../page/acting.js"),
    include_str!("../page/theme.js"),
    include_str!("../page/begin.js"),
];

/// SHA-256 over `round.toml` and `items.jsonl`: what a ballot is bound to.
fn digest_of(round: &Round) -> Result<String, DataError> {
    let files = [round.dir().settings(), round.dir().items()];
    let digests = files.iter().map(|path| sha256_file(path)).collect::<Result<Vec<String>, DataError>>()?;
    Ok(sha256_hex(digests.concat().as_bytes()))
}

fn pack_digest(round_sha256: &str, annotator: &Name) -> String {
    sha256_hex(format!("{SCHEMA}\n{round_sha256}\n{annotator}").as_bytes())
}

fn asked(round: &Round, annotator: &Name) -> Vec<Asked> {
    let order = round.order(annotator);
    let items = order.iter().filter_map(|id| round.item(id));
    let asked = |item: &l4d_votes::Item| Asked {
        item: item.id.to_string(),
        scene: item.scene.clone(),
        text: item.text.clone(),
    };
    items.map(asked).collect()
}

fn of_card(card: &SceneInfo, lengths: BTreeMap<Name, Vec<[usize; 2]>>) -> Shown {
    Shown {
        size: card.size.to_array(),
        views: card.views.clone(),
        frames: card.frames.clone(),
        opening: card.opening,
        frames_per_second: card.frames_per_second,
        is_capture: card.is_capture,
        objects: card.objects.len(),
        lengths,
    }
}

/// The pictures of a view, each followed by its numbers, and the lengths of both.
fn block(
    decoder: &mut Decoder,
    scene: &Name,
    card: &SceneInfo,
    view: &Name,
    progress: &dyn Progress,
) -> Result<(Vec<u8>, Vec<[usize; 2]>), DataError> {
    let mut block = Vec::new();
    let mut lengths = Vec::new();
    for &frame in &card.frames {
        let shown = decoder.decode(card, &(scene.clone(), view.clone(), frame))?;
        let picture = encode_jpeg(&shown.picture);
        let numbers = runs(shown.ids.ids.iter().map(|&id| number_of(card, id)));
        lengths.push([picture.len(), numbers.len()]);
        block.extend(picture);
        block.extend(numbers);
        progress.advance(1);
    }
    Ok((block, lengths))
}

/// The number of an id; 0 for what is no object.
fn number_of(card: &SceneInfo, id: u32) -> u8 {
    let object = card.objects.iter().find(|object| object.id == id && id != 0);
    object.and_then(|object| u8::try_from(object.number).ok()).unwrap_or(0)
}

/// Runs of equal values: the value, and how often it comes as an unsigned LEB128.
fn runs(values: impl Iterator<Item = u8>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut run: Option<(u8, usize)> = None;
    let push = |bytes: &mut Vec<u8>, (value, mut count): (u8, usize)| {
        bytes.push(value);
        while count >= 0x80 {
            bytes.push((count & 0x7f) as u8 | 0x80);
            count >>= 7;
        }
        bytes.push(count as u8);
    };
    for value in values {
        match &mut run {
            Some((of, count)) if *of == value => *count += 1,
            _ => {
                if let Some(run) = run.replace((value, 1)) {
                    push(&mut bytes, run);
                }
            }
        }
    }
    if let Some(run) = run {
        push(&mut bytes, run);
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_count_beyond_a_byte() {
        assert_eq!(runs(std::iter::empty()), Vec::<u8>::new());
        let values = std::iter::repeat_n(0, 300).chain([7, 7, 0]);
        assert_eq!(runs(values), [0, 0xac, 0x02, 7, 2, 0, 1]);
    }
}

//! Cards: a few pictures of one scene beside a few lines of text, one card below the other. What is written there is
//! the caller's; a card whose scene is not rendered shows its text alone.

use glam::UVec2;
use image::RgbImage;
use image::imageops::replace;
use l4d_data::scene::Scene;
use rayon::prelude::*;

use super::{GAP_PX, INK, MARGIN_PX, PAPER, SOFT_INK, Shot, factor, text};
use crate::exr::FrameError;
use crate::overlay::{Mark, marks};
use crate::text::Weight;

/// Pictures are enlarged by a whole factor until they are about this wide, pixels.
const PICTURE_WIDTH_PX: u32 = 256;
const TEXT_WIDTH_PX: u32 = 640;
const LINE_PX: u32 = 26;
const TITLE_LINE_PX: u32 = 34;
const CARD_GAP_PX: u32 = 22;
const SIZE_PX: f32 = 19.0;
const TITLE_PX: f32 = 26.0;
/// A page of more would not fit into the memory of a laptop.
pub const MOST_CARDS: usize = 200;

/// What a card shows.
#[derive(Debug, Clone)]
pub struct Card<'a> {
    /// The pictures, left to right; none where the scene is not rendered.
    pub shots: Vec<Shot<'a>>,
    /// Heading.
    pub title: String,
    /// Text below it; long lines are broken.
    pub lines: Vec<String>,
}

/// Draws at most [`MOST_CARDS`] cards on one page under a heading.
///
/// # Errors
/// A picture that cannot be read.
pub fn cards(heading: &str, cards: &[Card<'_>]) -> Result<RgbImage, FrameError> {
    let cards = &cards[..cards.len().min(MOST_CARDS)];
    let laid: Vec<Laid> = cards.iter().map(Laid::new).collect();
    let pictures_px = laid.iter().map(|card| card.pictures_px).max().unwrap_or(0);
    let width = 2 * MARGIN_PX + pictures_px + TEXT_WIDTH_PX;
    let content: u32 = laid.iter().map(|card| card.height_px + CARD_GAP_PX).sum();
    let height = 2 * MARGIN_PX + TITLE_LINE_PX + GAP_PX + content;
    let mut page = RgbImage::from_pixel(width, height, PAPER);
    text(Weight::Semibold, 30.0, INK).write(&mut page, MARGIN_PX as f32, MARGIN_PX as f32 - 6.0, heading);
    let drawn: Vec<Vec<RgbImage>> = cards.par_iter().map(pictures).collect::<Result<_, _>>()?;
    let mut top = MARGIN_PX + TITLE_LINE_PX + GAP_PX;
    for (card, pictures) in laid.iter().zip(drawn) {
        let mut x = MARGIN_PX;
        for picture in pictures {
            replace(&mut page, &picture, i64::from(x), i64::from(top));
            x += picture.width() + GAP_PX;
        }
        card.write(&mut page, MARGIN_PX + pictures_px, top);
        top += card.height_px + CARD_GAP_PX;
    }
    Ok(page)
}

/// A card with its lines broken and its sizes known.
struct Laid {
    title: Vec<String>,
    lines: Vec<String>,
    pictures_px: u32,
    height_px: u32,
}

impl Laid {
    fn new(card: &Card<'_>) -> Self {
        let width = TEXT_WIDTH_PX as f32;
        let title = text(Weight::Semibold, TITLE_PX, INK).wrap(&card.title, width);
        let style = text(Weight::Regular, SIZE_PX, INK);
        let lines: Vec<String> = card.lines.iter().flat_map(|line| style.wrap(line, width)).collect();
        let sizes: Vec<UVec2> = card.shots.iter().map(picture_size).collect();
        let text_px = title.len() as u32 * TITLE_LINE_PX + lines.len() as u32 * LINE_PX;
        Self {
            pictures_px: sizes.iter().map(|size| size.x + GAP_PX).sum::<u32>() + GAP_PX,
            height_px: sizes.iter().map(|size| size.y).max().unwrap_or(0).max(text_px),
            title,
            lines,
        }
    }

    fn write(&self, page: &mut RgbImage, left: u32, top: u32) {
        let mut y = top as f32 - 6.0;
        for line in &self.title {
            text(Weight::Semibold, TITLE_PX, INK).write(page, left as f32, y, line);
            y += TITLE_LINE_PX as f32;
        }
        for line in &self.lines {
            text(Weight::Regular, SIZE_PX, SOFT_INK).write(page, left as f32, y, line);
            y += LINE_PX as f32;
        }
    }
}

fn picture_size(shot: &Shot<'_>) -> UVec2 {
    UVec2::new(shot.scene.width, shot.scene.height) * factor(shot.scene, PICTURE_WIDTH_PX)
}

fn pictures(card: &Card<'_>) -> Result<Vec<RgbImage>, FrameError> {
    let draw = |shot: &Shot<'_>| shot.draw(factor(shot.scene, PICTURE_WIDTH_PX), &asked_marks(shot.scene));
    card.shots.iter().map(draw).collect()
}

/// Outlines of the objects: landmarks are many, and no query asks for them.
fn asked_marks(scene: &Scene) -> Vec<Mark> {
    marks(&scene.instances).into_iter().filter(|mark| !mark.faint).collect()
}

#[cfg(test)]
mod tests {
    use l4d_testing::Dataset;

    use super::*;

    #[test]
    fn a_card_has_its_pictures_left_and_its_words_right() {
        let fake = Dataset::new();
        let dir = fake.dir();
        let view = &fake.scene.cameras[0].name;
        let shot = |frame| Shot { scene: &fake.scene, dir: &dir, view, frame };
        let with = Card { shots: vec![shot(0), shot(48)], title: "1 the ball".into(), lines: Vec::new() };
        let without = Card { shots: Vec::new(), title: "2".into(), lines: vec!["not rendered".into()] };
        let page = cards("Two", &[with, without]).unwrap();
        // 128x96 twice as large, two of them, each with a gap, and one more before the text.
        let text_left = 28 + 2 * (256 + 8) + 8;
        assert_eq!(page.width(), text_left + 640 + 28);
        assert_eq!(page.height(), 2 * 28 + 34 + 8 + (192 + 22) + (34 + 26 + 22));
        let inked = |columns: std::ops::Range<u32>, rows: std::ops::Range<u32>| {
            columns.clone().any(|x| rows.clone().any(|y| *page.get_pixel(x, y) != PAPER))
        };
        let (first, second) = (70, 70 + 192 + 22);
        assert!(inked(28..284, first..first + 192) && inked(text_left..text_left + 200, first..first + 30));
        assert!(!inked(28..text_left - 1, second - 4..page.height()), "no picture beside the second");
        assert!(inked(text_left..text_left + 200, second + 20..second + 60));
    }

    #[test]
    fn a_missing_frame_is_named() {
        let fake = Dataset::new();
        let dir = fake.dir();
        let shot = Shot { scene: &fake.scene, dir: &dir, view: &fake.scene.cameras[0].name, frame: 1 };
        let card = Card { shots: vec![shot], title: String::new(), lines: Vec::new() };
        assert!(cards("One", &[card]).unwrap_err().to_string().contains("0001.exr"));
    }
}

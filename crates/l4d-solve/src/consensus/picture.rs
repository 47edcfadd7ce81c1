//! Consensus as a picture: a row for each view, a column for each of some frames, what each view marks outlined.
//!
//! Nothing is shown by colour alone: what goes on has a thick blue line, what does not a thin orange one, and words
//! are beside both.

use glam::UVec2;
use l4d_frames::closeup::Closeup;
use l4d_frames::drawn::{Rgb, RgbImage};
use l4d_frames::overlay::Mark;
use l4d_frames::text::{Style, Weight};
use l4d_masks::mask::PixelBox;

use super::candidate::{Part, Proposal};
use super::explain::group_letter;
use super::record::{Consensus, ViewVerdict};

const PAPER: Rgb<u8> = Rgb([24, 24, 26]);
const INK: Rgb<u8> = Rgb([240, 240, 240]);
/// Two of Okabe and Ito's colours that every kind of colour vision tells apart.
const GOES_ON: Rgb<u8> = Rgb([86, 180, 233]);
const DROPPED: Rgb<u8> = Rgb([230, 159, 0]);
const CELL_WIDTH_PX: u32 = 256;
const CAPTION_PX: u32 = 20;
const GAP_PX: u32 = 6;
const LABEL_PX: u32 = 220;
const HEADING_PX: u32 = 30;
/// More views than this do not fit on a page that anybody looks at.
const MOST_ROWS: usize = 24;
const MOST_COLUMNS: usize = 12;

const TEXT: Style = Style { weight: Weight::Regular, size_px: 16.0, colour: INK };
const STRONG: Style = Style { weight: Weight::Semibold, size_px: 18.0, colour: INK };

/// The page. `columns` frames, spread evenly over those in which a view marks something.
pub fn picture(proposals: &[Proposal<'_>], consensus: &Consensus, columns: usize) -> RgbImage {
    let frames = chosen_frames(consensus, columns.clamp(1, MOST_COLUMNS));
    let rows = proposals.len().min(MOST_ROWS);
    let cell = UVec2::new(CELL_WIDTH_PX, cell_height(proposals));
    let row_height = cell.y + CAPTION_PX + GAP_PX;
    let width = LABEL_PX + frames.len().max(2) as u32 * (cell.x + GAP_PX) + GAP_PX;
    let mut page = RgbImage::from_pixel(width, HEADING_PX + rows as u32 * row_height + GAP_PX, PAPER);
    let title = format!("{} of {} views go on", consensus.evidence.len(), consensus.views.len());
    let x = STRONG.write(&mut page, GAP_PX as f32, 5.0, &title);
    TEXT.write(&mut page, x, 6.0, &format!(": {}", consensus.decision.sentence()));
    for (view, proposal) in proposals.iter().take(rows).enumerate() {
        let top = HEADING_PX + view as u32 * row_height;
        write_label(&mut page, consensus, view, top);
        for (column, &frame) in frames.iter().enumerate() {
            let left = LABEL_PX + column as u32 * (cell.x + GAP_PX);
            draw_cell(&mut page, proposal, consensus, (view, frame), (UVec2::new(left, top), cell));
        }
    }
    page
}

fn chosen_frames(consensus: &Consensus, columns: usize) -> Vec<u32> {
    let frames_where = |test: fn(u64) -> bool| {
        let marked = consensus.views.iter().flat_map(|view| &view.frames);
        let mut frames: Vec<u32> =
            marked.filter(|marked| test(marked.pixels)).map(|marked| marked.frame).collect();
        frames.sort_unstable();
        frames.dedup();
        frames
    };
    let mut frames = frames_where(|pixels| pixels > 0);
    if frames.is_empty() {
        frames = frames_where(|_| true);
    }
    let count = columns.min(frames.len());
    let place = |column: usize| match count {
        0 | 1 => 0,
        _ => column * (frames.len() - 1) / (count - 1),
    };
    (0..count).filter_map(|column| frames.get(place(column)).copied()).collect()
}

/// As high as the first clip that has pixels asks for.
fn cell_height(proposals: &[Proposal<'_>]) -> u32 {
    let height_of = |proposal: &Proposal<'_>| {
        let (width, height) = (u64::from(proposal.clip.width), u64::from(proposal.clip.height));
        (width > 0 && height > 0).then(|| u64::from(CELL_WIDTH_PX) * height / width)
    };
    let height = proposals.iter().find_map(height_of).unwrap_or(0);
    height.clamp(u64::from(CELL_WIDTH_PX) / 4, u64::from(CELL_WIDTH_PX) * 2) as u32
}

fn write_label(page: &mut RgbImage, consensus: &Consensus, view: usize, top: u32) {
    let Some(record) = consensus.views.get(view) else { return };
    let (colour, word) = match record.standing {
        _ if consensus.evidence.contains(&view) => (GOES_ON, "GOES ON"),
        ViewVerdict::Absent | ViewVerdict::NoAnswer => (INK, record.outcome.as_str()),
        _ => (DROPPED, "dropped"),
    };
    let group =
        consensus.group_of(view).map_or(String::new(), |group| format!(", group {}", group_letter(group)));
    let x = GAP_PX as f32;
    let mut y = top as f32;
    let mut line = |style: Style, text: &str| {
        style.write(page, x, y, text);
        y += style.size_px + 2.0;
    };
    line(STRONG, record.view.as_str());
    line(Style { colour, ..STRONG }, &format!("{word}{group}"));
    if record.judges > 0 {
        line(TEXT, &format!("{} of {} judges vote", record.votes, record.judges));
    }
    let why = match &record.problem {
        Some(problem) => format!("{}: {problem}", record.standing.sentence()),
        None => record.standing.sentence().to_owned(),
    };
    for part in TEXT.wrap(&why, LABEL_PX as f32 - 2.0 * x).iter().take(4) {
        line(TEXT, part);
    }
}

/// A view at a frame, at a place of the page: (top left, size).
fn draw_cell(
    page: &mut RgbImage,
    proposal: &Proposal<'_>,
    consensus: &Consensus,
    (view, frame): (usize, u32),
    (place, size): (UVec2, UVec2),
) {
    let is_usable = !matches!(proposal.part(), Part::Unusable(_));
    let Some(seen) = proposal.clip.at(frame).filter(|_| is_usable) else { return };
    let (width, height) = seen.colour.dimensions();
    if width == 0 || height == 0 {
        return;
    }
    let mask = proposal.mask(frame);
    let is_marked = |column, row| mask.is_some_and(|mask| mask.get(column, row));
    let pixels = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
    let ids: Vec<u32> = pixels.map(|(column, row)| u32::from(is_marked(column, row))).collect();
    let whole = PixelBox { first_col: 0, first_row: 0, last_col: width - 1, last_row: height - 1 };
    let mut closeup = Closeup::cut(&seen.colour, &ids, whole, size);
    let goes_on = consensus.evidence.contains(&view);
    let (colour, line_px) = if goes_on { (GOES_ON, 3) } else { (DROPPED, 1) };
    let [agree, disagree, _] = consensus.tally(view, frame);
    let mark = Mark { id: 1, number: agree as usize, colour, faint: false };
    closeup.outline(&[mark], |_| line_px);
    for (column, row, pixel) in closeup.picture().enumerate_pixels() {
        if place.x + column < page.width() && place.y + row < page.height() {
            page.put_pixel(place.x + column, place.y + row, *pixel);
        }
    }
    let text = match (mask.is_some(), agree + disagree) {
        (true, 0) => format!("{frame}: marked, no judge sees it"),
        (true, _) => format!("{frame}: {agree} agree, {disagree} do not"),
        (false, 0) => format!("{frame}: nothing marked"),
        (false, _) => format!("{frame}: nothing marked, {disagree} disagree"),
    };
    TEXT.write(page, place.x as f32 + 2.0, (place.y + size.y) as f32 + 1.0, &text);
}

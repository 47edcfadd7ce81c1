//! Which thing was taken for which: a small matrix a scene, look-alikes in frames of their own.

use super::drawing::{
    AXIS, Anchor, BLUE, Colour, Drawing, Extent, GRID, INK, Lettering, MARGIN, ORANGE, PAPER, QUIET, SHADE,
    VERMILLION, WIDTH, leading,
};
use super::lettering;
use crate::rank::Board;
use crate::taken::{Choice, Confusion, Instead};

const GAP: f64 = 14.0;
/// Side of a cell; cells with long numbers are wider.
const CELL: f64 = 13.0;
/// More scenes than this make a figure that nobody reads, and so do more objects in one of them.
const MOST_SCENES: usize = 24;
const MOST_OBJECTS: usize = 24;
/// Panels are laid out in so many columns; wide ones take more than one.
const ABREAST: usize = 3;
const PITCH: f64 = (WIDTH - 2.0 * MARGIN + GAP) / ABREAST as f64;
/// Room for names: at least, and where they may be broken.
const LEAST_LABEL: f64 = 70.0;
const EASY_LABEL: f64 = 104.0;
/// Room for the number of a row and the gaps around it.
const NUMBER_ROOM: f64 = 22.0;

/// The figure of one method.
pub(crate) fn draw(board: &Board, method: &str, scenes: &[Confusion]) -> Drawing {
    let cell = cell_width(scenes);
    let fits = |scene: &&Confusion| {
        scene.objects.len() <= MOST_OBJECTS && LEAST_LABEL + cells_width(scene, cell) <= room(ABREAST)
    };
    let shown: Vec<&Confusion> = scenes.iter().filter(fits).take(MOST_SCENES).collect();
    let mut notes = vec![
        "A row a thing that is meant, a column a thing that was taken: the number of its row, L a landmark, – nothing. \
         Cells count queries. Frames hold things of one category: what stands in a frame beside its diagonal is a \
         look-alike that was taken instead."
            .to_owned(),
    ];
    if shown.len() < scenes.len() {
        notes.push(format!("{} more scenes stand in taken.csv.", scenes.len() - shown.len()));
    }
    let (mut drawing, above) =
        Drawing::titled(&format!("Which thing was taken for which: {method}"), board, &notes);
    if shown.is_empty() {
        let reason = match scenes.is_empty() {
            true => "No query has a visible target.",
            false => "Every scene has too many things for a picture.",
        };
        drawing.text(MARGIN, above + 36.0, reason, Lettering::LABEL);
        drawing.height = above + 48.0 + MARGIN;
        return drawing;
    }
    let mut top = legend(&mut drawing, above) + 28.0;
    let (mut column, mut bottom) = (0, top);
    for scene in shown {
        let span = span(scene, cell);
        if column + span > ABREAST {
            (column, top) = (0, bottom + 30.0);
        }
        let left = MARGIN + column as f64 * PITCH;
        let left_for_labels = room(span) - cells_width(scene, cell);
        // Panels of one column line up at their right; others stand below their title.
        let label_room = if span == 1 { left_for_labels } else { left_for_labels.min(wished_label(scene)) };
        bottom = f64::max(bottom, panel(&mut drawing, scene, (left, top), label_room, cell));
        column += span;
    }
    drawing.height = bottom + MARGIN;
    drawing
}

/// Width of so many columns of panels.
fn room(span: usize) -> f64 {
    span as f64 * PITCH - GAP
}

fn cells_width(scene: &Confusion, cell: f64) -> f64 {
    (scene.objects.len() + 2) as f64 * cell
}

/// Columns that a panel takes so that its names need not be broken much.
fn span(scene: &Confusion, cell: f64) -> usize {
    let wanted = wished_label(scene).clamp(LEAST_LABEL, EASY_LABEL);
    (1..ABREAST).find(|&span| room(span) - cells_width(scene, cell) >= wanted).unwrap_or(ABREAST)
}

/// Room in which no name of a scene has to be broken.
fn wished_label(scene: &Confusion) -> f64 {
    let names = scene.objects.iter().map(|object| Lettering::NUMBER.width(&object.name));
    names.fold(0.0, f64::max) + NUMBER_ROOM
}

fn cell_width(scenes: &[Confusion]) -> f64 {
    let queries = scenes.iter().flat_map(|scene| &scene.meant).map(Instead::queries);
    let numbers = queries.chain(scenes.iter().map(|scene| scene.objects.len()));
    let most = numbers.max().unwrap_or(0);
    f64::max(CELL, Lettering::NUMBER.width(&most.to_string()) + 3.0)
}

/// Gives its lower edge.
fn panel(
    drawing: &mut Drawing,
    scene: &Confusion,
    (left, top): (f64, f64),
    label_room: f64,
    cell: f64,
) -> f64 {
    let label = Lettering::NUMBER.anchored(Anchor::End);
    let names = left + label_room - NUMBER_ROOM;
    let cells = left + label_room;
    let count = scene.objects.len();
    let x_of = |column: usize| cells + column as f64 * cell;
    let title = lettering::wrap_name(scene.scene, |line| {
        Lettering::HEAD.width(line) <= label_room + count as f64 * cell
    });
    drawing.lines(left, top, &title, Lettering::HEAD);
    let head = top + (title.len() as f64 - 1.0) * leading(Lettering::HEAD) + 16.0;
    let heads = (1..=count).map(|place| place.to_string()).chain(["L".to_owned(), "–".to_owned()]);
    for (column, text) in heads.enumerate() {
        let note = Lettering::NOTE.anchored(Anchor::Middle);
        drawing.text(x_of(column) + cell / 2.0, head, &text, note);
    }

    let mut edges = vec![head + 4.0];
    for (place, (object, instead)) in scene.objects.iter().zip(&scene.meant).enumerate() {
        let fits = |line: &str| label.width(line) <= label_room - NUMBER_ROOM;
        let lines = lettering::wrap_name(&object.name, fits);
        let y = edges[place];
        let height = f64::max(CELL, lines.len() as f64 * leading(label) + 3.0);
        let middle = y + height / 2.0;
        let first = middle + 3.5 - (lines.len() as f64 - 1.0) * leading(label) / 2.0;
        let ink = if instead.queries() > 0 { INK } else { QUIET };
        drawing.lines(names, first, &lines, label.coloured(ink));
        let own = Lettering::NOTE.anchored(Anchor::End);
        drawing.text(cells - 4.0, middle + 3.5, &(place + 1).to_string(), own);
        for (column, (choice, queries)) in row(scene, place).into_iter().enumerate() {
            let extent = Extent { left: x_of(column), top: y, right: x_of(column + 1), bottom: y + height };
            let share = queries as f64 / instead.queries().max(1) as f64;
            fill(drawing, extent, choice, queries, share);
        }
        edges.push(y + height);
    }
    frames(drawing, scene, &x_of, &edges);
    edges.last().copied().unwrap_or(head)
}

/// What the cells of a row hold.
fn row(scene: &Confusion, place: usize) -> Vec<(Choice, usize)> {
    let category = &scene.objects[place].category;
    let choice = |column: usize| match column {
        _ if column == place => Choice::Meant,
        _ if scene.objects[column].category == *category => Choice::LookAlike,
        _ => Choice::OtherObject,
    };
    let Instead { objects, landmark, nothing } = &scene.meant[place];
    let objects = objects.iter().enumerate().map(|(column, &queries)| (choice(column), queries));
    objects.chain([(Choice::Landmark, *landmark), (Choice::Nothing, *nothing)]).collect()
}

/// A cell, the fuller of its colour the larger its share of the row.
fn fill(drawing: &mut Drawing, extent: Extent, choice: Choice, queries: usize, share: f64) {
    let Extent { left, top, right, bottom } = extent;
    let shade = if queries == 0 { PAPER } else { tint(colour(choice), 0.3 + 0.7 * share) };
    drawing.bar(left, top, right - left, bottom - top, shade);
    drawing.line([(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], 0.5, GRID);
    if queries > 0 {
        let ink = if luminance(shade) < 0.45 { PAPER } else { INK };
        let number = Lettering::NUMBER.anchored(Anchor::Middle).coloured(ink);
        let middle = (f64::midpoint(left, right), f64::midpoint(top, bottom) + 3.5);
        drawing.text(middle.0, middle.1, &queries.to_string(), number);
    }
}

/// Lines around the objects of each category and around all.
fn frames(drawing: &mut Drawing, scene: &Confusion, x_of: &impl Fn(usize) -> f64, edges: &[f64]) {
    let count = scene.objects.len();
    let mut frame = |columns: (usize, usize), rows: (usize, usize), width: f64, ink: Colour| {
        let (left, right, top, bottom) = (x_of(columns.0), x_of(columns.1), edges[rows.0], edges[rows.1]);
        drawing.line([(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], width, ink);
    };
    frame((0, count + 2), (0, count), 0.75, AXIS);
    frame((0, count), (0, count), 0.75, AXIS);
    let mut first = 0;
    for place in 1..=count {
        let is_end = place == count || scene.objects[place].category != scene.objects[first].category;
        if is_end {
            frame((first, place), (first, place), 1.25, INK);
            first = place;
        }
    }
}

fn colour(choice: Choice) -> Colour {
    match choice {
        Choice::Meant | Choice::Tied => BLUE,
        Choice::LookAlike => VERMILLION,
        Choice::OtherObject => ORANGE,
        Choice::Landmark | Choice::Nothing => SHADE,
    }
}

/// So much of a colour on paper.
fn tint((red, green, blue): Colour, share: f64) -> Colour {
    let mix = |part: u8| (255.0 - share * (255.0 - f64::from(part))).round() as u8;
    (mix(red), mix(green), mix(blue))
}

/// 0 to 1, as eyes weigh display colours.
fn luminance((red, green, blue): Colour) -> f64 {
    (0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue)) / 255.0
}

/// What the colours mean; gives the first free height below.
fn legend(drawing: &mut Drawing, above: f64) -> f64 {
    let baseline = above + 20.0;
    let mut x = MARGIN;
    let texts = [
        (Choice::Meant, "the one meant"),
        (Choice::LookAlike, "a look-alike"),
        (Choice::OtherObject, "another object"),
        (Choice::Landmark, "a landmark, or nothing"),
    ];
    for (choice, text) in texts {
        drawing.bar(x, baseline - 9.0, 11.0, 11.0, colour(choice));
        drawing.text(x + 16.0, baseline, text, Lettering::NOTE);
        x += 16.0 + Lettering::NOTE.width(text) + 14.0;
    }
    drawing.text(x, baseline, "(fuller: more of the row)", Lettering::NOTE);
    baseline
}

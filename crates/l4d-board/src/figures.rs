//! Figures: each is a function from a board to a plot, drawn by plotters as SVG and PNG.
//!
//! House style: Okabe and Ito's colours and greys, thin axes, percentages from zero, print size.

mod bars;
pub(crate) mod canvas;
pub(crate) mod counts;
mod lines;
pub(crate) mod scatter;
mod taken;

use l4d_data::results::Track;

use self::canvas::{Files, Plot};
use crate::board::{Board, Method};
use crate::error::BoardError;

/// More methods than this make a figure that cannot be read; the tables have them all.
const MOST_METHODS: usize = 24;

/// A figure that has not been drawn yet.
pub(crate) struct Figure<'a> {
    pub(crate) name: &'static str,
    /// What it shows, one sentence without markup.
    pub(crate) caption: &'static str,
    pub(crate) draw: Box<dyn Fn() -> Result<Files, BoardError> + Send + Sync + 'a>,
}

impl<'a> Figure<'a> {
    fn new(
        name: &'static str,
        [title, caption]: [&'static str; 2],
        notes: Vec<String>,
        plot: impl Plot + Send + Sync + 'a,
    ) -> Self {
        let draw = Box::new(move || canvas::files(name, title, &notes, &plot));
        Self { name, caption, draw }
    }
}

/// All figures of a board, in the order of the page.
pub(crate) fn all(board: &Board) -> Vec<Figure<'_>> {
    let left_out = board.methods.len() - shown(board).len();
    let notes = |about: &[&str]| {
        let mut notes = vec![board.heading.line()];
        notes.extend(about.iter().filter(|note| !note.is_empty()).map(|note| (*note).to_owned()));
        if left_out > 0 {
            notes.push(format!("{left_out} more methods are in the tables."));
        }
        notes
    };
    let (speed, untimed) = scatter::speed(board);
    let untimed =
        if untimed.is_empty() { String::new() } else { format!("No time reported: {}.", untimed.join(", ")) };
    let metrics = "Tube IoU is lower where masks are marked at times without a target, select where the wrong instance is \
                   outlined well.";
    let speed_notes = [
        "Wall seconds per query as methods report them, each of its own machine: compare orders of magnitude.",
        "Grey steps: ranked methods that no ranked method of their track beats in both. Upright lines: 95 % intervals.",
        &untimed,
    ];
    let over_time =
        ["Mean over the queries with a true or a predicted pixel in the frame; a false alarm counts 0."];
    let taken = ["Share of queries by the instance that the prediction overlaps most over the clip, %."];
    vec![
        Figure::new(
            "per_category",
            ["mIoU per category, %", "mIoU per category"],
            notes(&[]),
            bars::per_category(board),
        ),
        Figure::new("per_scale", ["mIoU per scale, %", "mIoU per scale"], notes(&[]), bars::per_scale(board)),
        Figure::new(
            "metrics",
            ["What mIoU cannot tell apart, %", "What mIoU cannot tell apart: tube IoU and select"],
            notes(&[metrics]),
            bars::metrics(board),
        ),
        Figure::new(
            "speed",
            ["Speed against error", "Speed against error: seconds per query, as reported, against mIoU"],
            notes(&speed_notes),
            speed,
        ),
        Figure::new("over_time", ["Mean IoU over the clip"; 2], notes(&over_time), lines::over_time(board)),
        Figure::new(
            "taken",
            ["What was taken for the thing that was meant"; 2],
            notes(&taken),
            taken::shares(board),
        ),
    ]
}

/// The name of a method with its track, unless that is the headline: methods of two tracks do not compete.
fn named(method: &Method) -> String {
    match method.track {
        Track::Colour => method.name.to_string(),
        Track::ColourDepth => format!("{} + depth", method.name),
    }
}

/// The methods that a figure shows. The unranked bracket the scale, so they stay.
fn shown(board: &Board) -> Vec<&Method> {
    let unranked = board.unranked().len().min(MOST_METHODS / 2);
    let ranked = board.ranked().len().min(MOST_METHODS - unranked);
    board.ranked()[..ranked].iter().chain(&board.unranked()[..unranked]).collect()
}

#[cfg(test)]
mod tests {
    use image::GenericImageView as _;
    use rayon::prelude::*;

    use super::*;
    use crate::sample;

    fn boards() -> Vec<(&'static str, Board)> {
        let mut bare = sample::method("bare", 289, 0.0);
        bare.iou_of_frames.clear();
        bare.scores.categories.clear();
        vec![
            ("one", sample::board(1)),
            ("fourteen", sample::answered(sample::board(14))),
            ("thirty", sample::board(30)),
            ("long", sample::answered(sample::long_names())),
            ("bare", sample::board_of(289, vec![bare])),
            ("tracks", sample::tracks()),
        ]
    }

    fn svg(figure: &Figure) -> String {
        let [(_, svg), _] = (figure.draw)().unwrap();
        String::from_utf8(svg).unwrap()
    }

    #[test]
    fn every_figure_of_every_board_says_what_it_is_of() {
        boards().par_iter().for_each(|(name, board)| {
            for figure in all(board) {
                let [(_, svg), (_, png)] = (figure.draw)().unwrap();
                let svg = String::from_utf8(svg).unwrap();
                for said in ["profile small", "protocol l4d", "<title>", "<desc>"] {
                    assert!(svg.contains(said), "{name}/{}: {said}", figure.name);
                }
                let size = image::load_from_memory(&png).unwrap().dimensions();
                assert_eq!(size.0, 2 * canvas::WIDTH, "{name}/{}", figure.name);
                let (width, height) = size;
                let print = format!("width=\"{}\" height=\"{}\"", width / 2, height / 2);
                let viewbox = format!("{print} viewBox=\"0 0 {width} {height}\"");
                assert!(svg.contains(&viewbox), "{name}/{}: {viewbox}", figure.name);
            }
        });
    }

    #[test]
    fn the_same_board_gives_the_same_bytes() {
        let board = sample::tracks();
        for (first, second) in all(&board).into_iter().zip(all(&board)) {
            assert!((first.draw)().unwrap() == (second.draw)().unwrap(), "{}", first.name);
        }
    }

    #[test]
    fn methods_are_named_with_their_track_and_the_untimed_are_told() {
        let mut board = sample::tracks();
        board.methods[0].seconds = None;
        for figure in
            all(&board).iter().filter(|figure| ["metrics", "speed", "over_time"].contains(&figure.name))
        {
            let svg = svg(figure);
            assert!(svg.contains("deep + depth") && !svg.contains("bright + depth"), "{}", figure.name);
            assert_eq!(svg.contains("No time reported: bright"), figure.name == "speed");
        }
        for method in &mut board.methods {
            method.seconds = None;
        }
        let figures = all(&board);
        let speed = figures.iter().find(|figure| figure.name == "speed").unwrap();
        assert!(svg(speed).contains("No method says how long it took."));
    }

    #[test]
    fn hostile_titles_stay_text() {
        let mut board = sample::board_of(1, vec![sample::method("a", 1, 10.0)]);
        board.heading.benchmark = "<script>\u{0}&\"</script> ".repeat(20);
        for figure in all(&board) {
            let svg = svg(&figure);
            assert!(!svg.contains("<script") && !svg.contains('\0'), "{}", figure.name);
        }
    }

    #[test]
    #[ignore = "writes every figure of every board into L4D_BOARD_GALLERY, to be looked at"]
    fn gallery() {
        let folder = std::path::PathBuf::from(std::env::var_os("L4D_BOARD_GALLERY").unwrap());
        for (name, board) in boards() {
            crate::publish(&board, &folder.join(name), crate::Answers::Named, true).unwrap();
        }
    }
}

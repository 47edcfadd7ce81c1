//! What every figure must keep, whatever the board.

use std::collections::BTreeMap;

use image::GenericImageView as _;
use l4d_data::layout::BenchDir;

use super::drawing::{Drawing, Extent, Shape, WIDTH};
use super::*;
use crate::sample;

fn boards() -> Vec<(&'static str, Board)> {
    let mut one_bare = sample::row("bare", 289, 0.0);
    one_bare.frames.clear();
    one_bare.scores.categories.clear();
    one_bare.scores.headline.tube_iou = None;
    vec![
        ("one", sample::board(1)),
        ("two", sample::board(2)),
        ("six", sample::board(6)),
        ("baselines", {
            let rows = sample::board(7).unranked.into_iter().map(|entry| entry.row).collect();
            Board::new(sample::heading(289, 0), rows).unwrap()
        }),
        ("fourteen", sample::board(14)),
        ("thirty", sample::board(30)),
        ("long", sample::long_names()),
        ("bare", Board::new(sample::heading(289, 0), vec![one_bare]).unwrap()),
        ("hand", sample::hand_made()),
    ]
}

fn texts(drawing: &Drawing) -> Vec<(Extent, &str)> {
    let text = |shape| match shape {
        &Shape::Text { x, baseline, ref text, lettering } => {
            Some((Extent::of_text(x, baseline, text, lettering), text.as_str()))
        }
        _ => None,
    };
    drawing.shapes.iter().filter_map(text).collect()
}

#[test]
fn nothing_leaves_the_canvas() {
    for (board_name, board) in boards() {
        for Figure { name, drawing, .. } in all(&board) {
            let canvas = Extent { left: 0.0, top: 0.0, right: WIDTH, bottom: drawing.height };
            for (extent, text) in texts(&drawing) {
                assert!(canvas.holds(extent), "{board_name}/{name}: `{text}` at {extent:?}");
            }
            for shape in &drawing.shapes {
                let corners = match shape {
                    Shape::Bar { x, y, width, height, .. } => vec![(*x, *y), (x + width, y + height)],
                    Shape::Line { points, .. } | Shape::Polygon { points, .. } => points.clone(),
                    Shape::Dot { x, y, radius, .. } => {
                        vec![(x - radius, y - radius), (x + radius, y + radius)]
                    }
                    Shape::Text { .. } => Vec::new(),
                };
                for (x, y) in corners {
                    let inside = (0.0..=WIDTH).contains(&x) && (0.0..=drawing.height).contains(&y);
                    assert!(inside, "{board_name}/{name}: {shape:?}");
                }
            }
        }
    }
}

#[test]
fn no_text_overlaps_another() {
    for (board_name, board) in boards() {
        for Figure { name, drawing, .. } in all(&board) {
            let texts = texts(&drawing);
            for (index, (extent, text)) in texts.iter().enumerate() {
                let hit = texts[..index].iter().find(|(other, _)| other.overlaps(*extent));
                assert!(hit.is_none(), "{board_name}/{name}: `{text}` on {hit:?}");
            }
        }
    }
}

#[test]
fn every_method_and_group_is_named_in_the_svg() {
    for (board_name, board) in boards() {
        for Figure { name, drawing, .. } in all(&board) {
            let svg = svg(name, &drawing).unwrap();
            // Names may be broken into lines; all text of the document in order, without spaces.
            let glued: String = svg_texts(&svg).concat().split_whitespace().collect();
            let (rows, _) = shown(&board);
            let with_data = |row: &&BoardRow| name != "over_time" || !row.frames.is_empty();
            for row in rows.into_iter().map(|(_, row)| row).filter(with_data) {
                if name == "metrics" && row.scores.headline.tube_iou.is_none() {
                    continue;
                }
                assert!(glued.contains(row.name.as_str()), "{board_name}/{name} lacks {}: {glued}", row.name);
            }
            let groups: &[&str] = match name {
                "per_category" => &["Attribute", "Action", "Spatial", "Interaction"],
                "per_scale" => &["Outdoor", "Room", "Tabletop"],
                "metrics" => &["mIoU,%", "tubeIoU,%", "select,%"],
                _ => &["meanIoU,%", "canonicalframe"],
            };
            for group in groups {
                assert!(glued.contains(group), "{board_name}/{name} lacks {group}");
            }
            for said in ["profilesmall", "protocoll4d", "1.0.0", "verifiedbypeople"] {
                assert!(glued.contains(said), "{board_name}/{name} does not say {said}");
            }
        }
    }
}

#[test]
fn an_svg_is_well_formed_and_keeps_to_its_viewbox() {
    for (board_name, board) in boards() {
        for Figure { name, drawing, .. } in all(&board) {
            let svg = svg(name, &drawing).unwrap();
            let tags = svg_tags(&svg);
            let (root, attributes) = &tags[0];
            assert_eq!(*root, "svg", "{board_name}/{name}");
            let size = |key: &str| attributes[key].parse::<f64>().unwrap();
            let box_sides: Vec<f64> =
                attributes["viewBox"].split(' ').map(|side| side.parse().unwrap()).collect();
            assert_eq!(box_sides, [0.0, 0.0, 4.0 * size("width"), 4.0 * size("height")]);
            for (tag, attributes) in &tags[1..] {
                let number = |key: &str| attributes.get(key).map(|value| value.parse::<f64>().unwrap());
                for (key, limit) in [
                    ("x", box_sides[2]),
                    ("x2", box_sides[2]),
                    ("cx", box_sides[2]),
                    ("y", box_sides[3]),
                    ("y2", box_sides[3]),
                    ("cy", box_sides[3]),
                ] {
                    let at = number(key).unwrap_or(0.0);
                    assert!((0.0..=limit).contains(&at), "{board_name}/{name}: {tag} {key}={at}");
                }
                assert!(
                    number("width").unwrap_or(0.0) >= 0.0,
                    "{board_name}/{name}: {tag} of negative width"
                );
            }
        }
    }
}

#[test]
fn the_same_board_gives_the_same_bytes() {
    let board = sample::board(6);
    for (first, second) in all(&board).into_iter().zip(all(&board)) {
        assert_eq!(svg("x", &first.drawing).unwrap(), svg("x", &second.drawing).unwrap());
        assert_eq!(png("x", &first.drawing).unwrap(), png("x", &second.drawing).unwrap());
    }
}

#[test]
fn a_png_has_twice_the_print_size_and_carries_ink_and_accent() {
    let board = sample::board(6);
    for Figure { name, drawing, .. } in all(&board) {
        let picture = image::load_from_memory(&png(name, &drawing).unwrap()).unwrap();
        assert_eq!(picture.dimensions(), (2 * WIDTH as u32, 2 * drawing.height.ceil() as u32), "{name}");
        let pixels = picture.to_rgb8();
        let count = |colour: (u8, u8, u8)| {
            pixels.pixels().filter(|pixel| (pixel[0], pixel[1], pixel[2]) == colour).count()
        };
        assert!(count(drawing::PAPER) > 100_000, "{name}: no paper");
        assert!(count(drawing::INK) > 500, "{name}: no lettering");
        assert!(count(drawing::BLUE) > 50, "{name}: no ranked method");
    }
}

#[test]
fn hostile_titles_stay_text() {
    let mut heading = sample::heading(1, 0);
    heading.benchmark = "<script>\u{0}&\"</script> ".repeat(20);
    let board = Board::new(heading, vec![sample::row("a", 1, 10.0)]).unwrap();
    for Figure { name, drawing, .. } in all(&board) {
        let svg = svg(name, &drawing).unwrap();
        assert!(!svg.contains("<script") && !svg.contains('\0'), "{name}");
        png(name, &drawing).unwrap();
    }
}

/// Writes every figure of every board where `L4D_BOARD_GALLERY` says, to be looked at.
#[test]
fn gallery() {
    let Some(folder) = std::env::var_os("L4D_BOARD_GALLERY") else { return };
    for (board_name, board) in boards() {
        let (statistics, bench) = (sample::statistics(&board), BenchDir::new("nowhere"));
        crate::publish(
            &board,
            &statistics,
            &sample::details(),
            &[],
            &bench,
            &std::path::Path::new(&folder).join(board_name),
        )
        .unwrap();
    }
}

fn svg_tags(svg: &str) -> Vec<(&str, BTreeMap<&str, &str>)> {
    let tag = |piece| {
        let piece: &str = piece;
        let body = piece.split_once('>')?.0.trim_end_matches('/');
        let (name, mut rest) = body.split_once(' ').unwrap_or((body, ""));
        let mut attributes = BTreeMap::new();
        while let Some((key, after)) = rest.split_once("=\"") {
            let (value, tail) = after.split_once('"')?;
            attributes.insert(key.trim(), value);
            rest = tail;
        }
        (!name.starts_with('/')).then_some((name, attributes))
    };
    svg.split('<').skip(1).filter_map(tag).collect()
}

fn svg_texts(svg: &str) -> Vec<String> {
    let content = |piece: &str| {
        piece.starts_with("text ").then(|| piece.split_once('>')).flatten().map(|(_, text)| text.to_owned())
    };
    svg.split('<').filter_map(content).collect()
}

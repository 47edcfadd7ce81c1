//! What every figure must keep, whatever the board.

use std::collections::BTreeMap;

use image::GenericImageView as _;
use l4d_data::Name;
use l4d_data::layout::BenchDir;
use l4d_score::Exam;

use super::drawing::{Anchor, Drawing, Extent, INK, Lettering, Shape, WIDTH};
use super::*;
use crate::detail::Thing;
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
        ("tracks", sample::tracks()),
    ]
}

/// The figures of a board of made-up methods.
fn all(board: &Board) -> Vec<Figure> {
    super::all(board, &sample::statistics(board))
}

/// The same, and those of what its methods made of the queries of an exam.
fn all_on(board: &Board, exam: &Exam) -> Vec<Figure> {
    let mut figures = all(board);
    figures.extend(detailed(board, &sample::details_on(exam, board)));
    figures
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
    let exam = sample::exam(&[]);
    for (board_name, board) in boards() {
        for Figure { name, drawing, .. } in all_on(&board, &exam) {
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
    let exam = sample::exam(&[]);
    for (board_name, board) in boards() {
        for Figure { name, drawing, .. } in all_on(&board, &exam) {
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
            let svg = paint::svg(&name, &drawing).unwrap();
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
            let groups: &[&str] = match name.as_str() {
                "per_category" => &["Attribute", "Action", "Spatial", "Interaction"],
                "per_scale" => &["Outdoor", "Room", "Tabletop"],
                "metrics" => &["mIoU,%", "tubeIoU,%", "select,%"],
                "speed" => &["Wallsecondsaquery"],
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
            let svg = paint::svg(&name, &drawing).unwrap();
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
        assert_eq!(paint::svg("x", &first.drawing).unwrap(), paint::svg("x", &second.drawing).unwrap());
        assert_eq!(paint::png("x", &first.drawing).unwrap(), paint::png("x", &second.drawing).unwrap());
    }
}

#[test]
fn a_png_has_twice_the_print_size_and_carries_ink_and_accent() {
    let board = sample::board(6);
    for Figure { name, drawing, .. } in all(&board) {
        let picture = image::load_from_memory(&paint::png(&name, &drawing).unwrap()).unwrap();
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
        let svg = paint::svg(&name, &drawing).unwrap();
        assert!(!svg.contains("<script") && !svg.contains('\0'), "{name}");
        paint::png(&name, &drawing).unwrap();
    }
}

#[test]
fn the_type_is_large_enough_for_print() {
    let exam = sample::exam(&[]);
    let board = sample::board(6);
    for Figure { name, drawing, .. } in all_on(&board, &exam) {
        for shape in &drawing.shapes {
            if let Shape::Text { text, lettering, .. } = shape {
                // Two columns of a paper are 6.9 inches, a point is a 72nd of one.
                let points = lettering.size * 6.9 * 72.0 / WIDTH;
                assert!(points >= 6.0, "{name}: `{text}` is {points} pt");
            }
        }
    }
}

/// The lying lines in ink: stems of whiskers, from their low to their high end.
fn stems(drawing: &Drawing) -> Vec<(f64, f64)> {
    let stem = |shape: &Shape| match shape {
        Shape::Line { points, width: 1.0, colour: INK } if points[0].1 == points[1].1 => {
            Some((points[0].0, points[1].0))
        }
        _ => None,
    };
    drawing.shapes.iter().filter_map(stem).collect()
}

#[test]
fn whiskers_end_where_the_interval_does() {
    let board = Board::new(sample::heading(4, 0), vec![sample::row("a", 4, 40.0)]).unwrap();
    let statistics = sample::statistics(&board);
    let drawing = bars::per_category(&board, &statistics);
    let bars: Vec<(f64, f64)> = drawing
        .shapes
        .iter()
        .filter_map(|shape| match shape {
            Shape::Bar { x, width, fill: drawing::BLUE, .. } => Some((*x, *width)),
            _ => None,
        })
        .collect();
    // One is the legend's.
    let stems = &stems(&drawing)[1..];
    assert_eq!((bars.len(), stems.len()), (4, 4));
    for ((x, width), (low, high)) in bars.iter().zip(stems) {
        let scale = width / 40.0;
        assert!((low - (x + 35.5 * scale)).abs() < 1e-9 && (high - (x + 44.5 * scale)).abs() < 1e-9);
    }
}

#[test]
fn few_scenes_are_marked_and_a_single_one_has_no_whisker() {
    let board = Board::new(sample::heading(4, 0), vec![sample::row("a", 4, 40.0)]).unwrap();
    let mut statistics = sample::statistics(&board);
    let few = |statistics: &mut Statistics, scenes| {
        for group in &mut statistics.methods[0].groups {
            (group.scenes, group.few_scenes) = (scenes, true);
        }
    };
    let says = |drawing: &Drawing, what: &str| texts(drawing).iter().any(|(_, text)| text.contains(what));
    let sure = bars::per_scale(&board, &statistics);
    assert!(says(&sure, "21 scenes") && !says(&sure, "!"));
    few(&mut statistics, 6);
    let unsure = bars::per_scale(&board, &statistics);
    assert!(says(&unsure, "6 scenes !") && says(&unsure, "! from fewer than 8 scenes"));
    assert!(stems(&unsure).len() > 2 * stems(&sure).len(), "not in dashes");
    few(&mut statistics, 1);
    for group in &mut statistics.methods[0].groups {
        group.estimates.miou.as_mut().unwrap().interval = None;
    }
    assert!(stems(&bars::per_scale(&board, &statistics)).is_empty());
}

/// A board of complete methods with these seconds in all and this mIoU; the last is not ranked.
fn timed(methods: &[(&str, Option<f64>, f64)]) -> Board {
    let mut rows = Vec::new();
    for (place, &(name, seconds, miou)) in methods.iter().enumerate() {
        let mut row = sample::row(name, 10, miou);
        row.seconds = seconds;
        if place + 1 == methods.len() {
            row.unranked_because = vec!["used ground truth"];
        }
        rows.push(row);
    }
    Board::new(sample::heading(10, 0), rows).unwrap()
}

#[test]
fn the_front_is_of_ranked_methods_and_the_untimed_are_named() {
    let board = timed(&[
        ("slow", Some(1000.0), 70.0),
        ("beaten", Some(1000.0), 60.0),
        ("quick", Some(10.0), 40.0),
        ("worse", Some(20.0), 30.0),
        ("silent", None, 50.0),
        ("instant", Some(0.0), 20.0),
        ("seer", Some(1.0), 100.0),
    ]);
    let drawing = speed::draw(&board);
    let named = texts(&drawing);
    assert!(named.iter().any(|(_, text)| *text == "No time reported: silent, instant."), "{named:?}");
    // Quick and slow: right from the one, up to the other, and on.
    let stairs: Vec<&Vec<(f64, f64)>> = drawing
        .shapes
        .iter()
        .filter_map(|shape| match shape {
            Shape::Line { points, colour: drawing::SHADE, .. } => Some(points),
            _ => None,
        })
        .collect();
    let [points] = stairs[..] else { panic!("{stairs:?}") };
    let dot_of = |name: &str| {
        let dots: Vec<(f64, f64)> = drawing
            .shapes
            .iter()
            .filter_map(|shape| match shape {
                Shape::Dot { x, y, radius: 5.0, .. } => Some((*x, *y)),
                _ => None,
            })
            .collect();
        // The legend has two of its own; then the methods in the order of the board.
        dots[2 + ["slow", "beaten", "quick", "worse", "seer"]
            .iter()
            .position(|other| *other == name)
            .unwrap()]
    };
    let (quick, slow) = (dot_of("quick"), dot_of("slow"));
    assert_eq!(points[..3], [quick, (slow.0, quick.1), slow]);
    assert_eq!((points.len(), points[3].1), (4, slow.1));
}

#[test]
fn each_track_has_its_front_and_its_mark() {
    let board = sample::tracks();
    let drawing = speed::draw(&board);
    let fronts: Vec<(f64, f64)> = [drawing::SHADE, drawing::SKY]
        .iter()
        .flat_map(|wanted| {
            drawing.shapes.iter().find_map(|shape| match shape {
                Shape::Line { points, width: 2.5, colour } if colour == wanted => Some(points[0]),
                _ => None,
            })
        })
        .collect();
    assert_eq!(fronts.len(), 2, "what learned from depth is above the others and leaves them their front");
    assert!(fronts[0].1 > fronts[1].1, "{fronts:?}");
    for figure in all(&board) {
        let named = texts(&figure.drawing);
        let has = |text: &str| named.iter().any(|(_, found)| found.contains(text));
        assert!(has("deep + depth") && has("deeper + depth") && !has("bright +"), "{}", figure.name);
    }
}

#[test]
fn the_best_of_a_track_is_bold_where_it_has_rivals() {
    let bold = |board: &Board| {
        let drawing = bars::per_scale(board, &sample::statistics(board));
        let number = |shape: &Shape| match shape {
            Shape::Text { text, lettering, .. }
                if *lettering == Lettering::NUMBER.bold().anchored(Anchor::End) =>
            {
                Some(text.clone())
            }
            _ => None,
        };
        drawing.shapes.iter().filter_map(number).collect::<Vec<_>>()
    };
    assert_eq!(bold(&sample::tracks()), ["40.0", "95.0"].repeat(3));
    let alone = Board::new(sample::heading(4, 0), vec![sample::row("a", 4, 40.0)]).unwrap();
    assert!(bold(&alone).is_empty());
}

#[test]
fn speed_without_a_time_says_so() {
    let board = timed(&[("a", None, 10.0), ("b", Some(0.0), 20.0)]);
    let drawing = speed::draw(&board);
    let named = texts(&drawing);
    assert!(named.iter().any(|(_, text)| *text == "No method says how long it took."), "{named:?}");
    assert!(named.iter().any(|(_, text)| *text == "No time reported: a, b."), "{named:?}");
}

#[test]
fn a_confusion_says_which_look_alike_was_taken() {
    let (exam, board) = (sample::exam(&["room_living_cats"]), sample::board(1));
    let mut details = sample::details_on(&exam, &board);
    let queries: Vec<_> = details.asked.queries().map(|(query, _)| query.clone()).collect();
    let name = |text: &str| Some(Name::new(text).unwrap());
    for (query, found) in queries.iter().zip(&mut details.methods[0].queries) {
        found.taken = match query.referents[0].as_str() {
            "cat_walker" => name("cat_sleeper"),
            "cat_player" => name("sofa"),
            "cat_sleeper" => name("yarn_ball_still"),
            _ => None,
        };
    }
    let choices = choices(&board, &details);
    let confusions = confusions(&choices[0], &details);
    let [confusion] = &confusions[..] else { panic!("{confusions:?}") };
    let objects: Vec<&str> = confusion.objects.iter().map(|thing| thing.name.as_str()).collect();
    let place = |name: &str| objects.iter().position(|other| *other == name).unwrap();
    let counted = |name: &str| queries.iter().filter(|query| query.referents[0].as_str() == name).count();
    assert!(objects[..3].iter().all(|name| name.starts_with("cat_")), "{objects:?}");
    let row = |name: &str| &confusion.meant[place(name)];
    assert_eq!(row("cat_walker").objects[place("cat_sleeper")], counted("cat_walker"));
    assert_eq!(row("cat_player").landmark, counted("cat_player"));
    assert_eq!(row("cat_sleeper").objects[place("yarn_ball_still")], counted("cat_sleeper"));
    assert_eq!(row("yarn_ball_played").nothing, counted("yarn_ball_played"));
    let all: usize = confusion.meant.iter().map(crate::taken::Instead::queries).sum();
    assert_eq!(all, queries.len());
}

#[test]
fn confusions_of_many_things_with_long_names_have_room() {
    let scene = Name::new("s".repeat(80)).unwrap();
    for (count, queries) in [(1, 1), (10, 9), (24, 100), (24, 1000), (25, 1)] {
        let things: Vec<Thing> = (0..count)
            .map(|place| Thing {
                name: Name::new(format!("{}-{place}", "a-long-name_".repeat(6))).unwrap(),
                role: l4d_data::Role::Object,
                category: format!("kind {}", place / 3),
            })
            .collect();
        let row = |place: usize| {
            let mut objects = vec![0; count];
            objects[place] = queries;
            crate::taken::Instead { objects, landmark: 1, nothing: 2 }
        };
        let confusion = crate::taken::Confusion {
            scene: &scene,
            objects: things.iter().collect(),
            meant: (0..count).map(row).collect(),
        };
        let drawing = confusion::draw(&sample::board(1), "m", &vec![confusion; 3]);
        let canvas = Extent { left: 0.0, top: 0.0, right: WIDTH, bottom: drawing.height };
        let texts = texts(&drawing);
        for (index, (extent, text)) in texts.iter().enumerate() {
            assert!(canvas.holds(*extent), "{count} {queries}: `{text}` at {extent:?}");
            let hit = texts[..index].iter().find(|(other, _)| other.overlaps(*extent));
            assert!(hit.is_none(), "{count} {queries}: `{text}` on {hit:?}");
        }
        let is_refused = texts.iter().any(|(_, text)| text.contains("too many things"));
        assert_eq!(is_refused, count == 25 || queries == 1000, "{count} {queries}");
    }
}

#[test]
fn boards_without_a_query_have_figures_that_say_so() {
    let board = sample::board(2);
    let figures = detailed(&board, &sample::details());
    assert_eq!(figures.iter().map(|figure| figure.name.as_str()).collect::<Vec<_>>(), ["taken"]);
    let drawing = confusion::draw(&board, "m", &[]);
    assert!(texts(&drawing).iter().any(|(_, text)| *text == "No query has a visible target."));
}

/// Writes every figure of every board where `L4D_BOARD_GALLERY` says, to be looked at.
#[test]
fn gallery() {
    let Some(folder) = std::env::var_os("L4D_BOARD_GALLERY") else { return };
    let exam = sample::exam(&[]);
    for (board_name, board) in boards() {
        let (statistics, bench) = (sample::statistics(&board), BenchDir::new("nowhere"));
        crate::publish(
            &board,
            &statistics,
            &sample::details_on(&exam, &board),
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

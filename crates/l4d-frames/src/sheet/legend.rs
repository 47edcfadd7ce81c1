//! Below the pictures: which number is which instance, and the queries.

use image::RgbImage;
use l4d_data::scene::{Instance, Scene};
use l4d_data::timeline::LAST_FRAME;
use l4d_data::{Query, Role, Temporal};

use super::{INK, SOFT_INK, text};
use crate::overlay::{Mark, label};
use crate::text::Weight;

const LINE_PX: u32 = 28;
const HEADING_PX: u32 = 46;
const ENTRY_WIDTH_PX: u32 = 480;
const LABEL_WIDTH_PX: u32 = 34;
const NUMBER_WIDTH_PX: u32 = 52;
const REFERENTS_WIDTH_PX: u32 = 84;
const CATEGORY_WIDTH_PX: u32 = 190;
const FRAMES_WIDTH_PX: u32 = 230;
const COLUMN_GAP_PX: u32 = 48;
const SIZE_PX: f32 = 20.0;

pub(super) struct Legend<'a> {
    entries: Vec<(&'a Instance, &'a Mark)>,
    columns: u32,
    queries: Vec<QueryLines<'a>>,
    width_px: u32,
    sentence_px: u32,
}

struct QueryLines<'a> {
    query: &'a Query,
    referents: Vec<&'a Mark>,
    sentence: Vec<String>,
}

impl<'a> Legend<'a> {
    pub(super) fn new(scene: &'a Scene, marks: &'a [Mark], queries: &'a [Query], width_px: u32) -> Self {
        let entries: Vec<_> = scene.instances.iter().zip(marks).collect();
        let style = text(Weight::Regular, SIZE_PX, INK);
        let fixed =
            NUMBER_WIDTH_PX + REFERENTS_WIDTH_PX + COLUMN_GAP_PX + CATEGORY_WIDTH_PX + FRAMES_WIDTH_PX;
        let sentence_width = width_px.saturating_sub(fixed).max(200) as f32;
        let lines = |query: &'a Query| QueryLines {
            query,
            referents: entries
                .iter()
                .filter(|(instance, _)| query.referents.contains(&instance.name))
                .map(|(_, mark)| *mark)
                .collect(),
            sentence: style.wrap(&query.text, sentence_width),
        };
        let queries: Vec<QueryLines> = queries.iter().map(lines).collect();
        let widest = queries.iter().flat_map(|lines| &lines.sentence).map(|line| style.width_px(line));
        let sentence_px = widest.fold(0.0, f32::max).ceil() as u32;
        Self { columns: (width_px / ENTRY_WIDTH_PX).max(1), entries, queries, width_px, sentence_px }
    }

    pub(super) fn height_px(&self) -> u32 {
        let entry_rows = (self.entries.len() as u32).div_ceil(self.columns);
        let query_lines: u32 = self.queries.iter().map(QueryLines::line_count).sum();
        let queries = if self.queries.is_empty() { 0 } else { HEADING_PX + query_lines * LINE_PX };
        HEADING_PX + entry_rows * LINE_PX + queries
    }

    pub(super) fn draw(&self, page: &mut RgbImage, left: u32, top: u32) {
        heading(page, left, top, "Instances");
        let top = top + HEADING_PX;
        let rows = (self.entries.len() as u32).div_ceil(self.columns).max(1);
        for (index, (instance, mark)) in self.entries.iter().enumerate() {
            let (column, row) = (index as u32 / rows, index as u32 % rows);
            let x = left + column * (self.width_px / self.columns);
            draw_entry(page, x, top + row * LINE_PX, instance, mark);
        }
        if self.queries.is_empty() {
            return;
        }
        let mut y = top + rows * LINE_PX;
        heading(page, left, y, "Queries");
        y += HEADING_PX;
        for lines in &self.queries {
            self.draw_query(page, left, y, lines);
            y += lines.line_count() * LINE_PX;
        }
    }

    fn draw_query(&self, page: &mut RgbImage, left: u32, top: u32, lines: &QueryLines) {
        let y = top as f32;
        let soft = text(Weight::Regular, SIZE_PX, SOFT_INK);
        soft.write(page, left as f32, y, &lines.query.id.number);
        let mut x = (left + NUMBER_WIDTH_PX) as f32 + 12.0;
        for mark in &lines.referents {
            label(page, mark, x, y + SIZE_PX / 2.0);
            x += 26.0;
        }
        let sentence_left = (left + NUMBER_WIDTH_PX + REFERENTS_WIDTH_PX) as f32;
        for (index, line) in lines.sentence.iter().enumerate() {
            text(Weight::Regular, SIZE_PX, INK).write(
                page,
                sentence_left,
                y + (index as u32 * LINE_PX) as f32,
                line,
            );
        }
        let category_left = sentence_left + (self.sentence_px + COLUMN_GAP_PX) as f32;
        let categories: Vec<&str> = lines.query.categories.iter().map(|category| category.as_str()).collect();
        soft.write(page, category_left, y, &categories.join(" + "));
        soft.write(page, category_left + CATEGORY_WIDTH_PX as f32, y, &when(lines.query));
    }
}

impl QueryLines<'_> {
    fn line_count(&self) -> u32 {
        self.sentence.len().max(1) as u32
    }
}

fn heading(page: &mut RgbImage, left: u32, top: u32, words: &str) {
    text(Weight::Semibold, 22.0, INK).write(page, left as f32, top as f32 + 12.0, words);
}

fn draw_entry(page: &mut RgbImage, left: u32, top: u32, instance: &Instance, mark: &Mark) {
    let y = top as f32;
    label(page, mark, left as f32 + 12.0, y + SIZE_PX / 2.0);
    let x = (left + LABEL_WIDTH_PX) as f32;
    let end = text(Weight::Semibold, SIZE_PX, INK).write(page, x, y, &instance.name);
    let mut facts = vec![instance.category.clone()];
    if instance.role == Role::Landmark {
        facts.push("landmark".to_owned());
    }
    let tells_more = |value: &String| value != "none" && !instance.name.contains(value.as_str());
    facts.extend(instance.attributes.iter().filter(|(_, value)| tells_more(value)).map(in_words));
    text(Weight::Regular, SIZE_PX, SOFT_INK).write(page, end + 10.0, y, &facts.join(", "));
}

fn in_words((key, value): (&String, &String)) -> String {
    match value.as_str() {
        "yes" => key.clone(),
        "no" => format!("no {key}"),
        _ => value.clone(),
    }
}

fn when(query: &Query) -> String {
    let intervals: Vec<String> =
        query.frames.iter().map(|interval| format!("{}–{}", interval.first(), interval.last())).collect();
    match query.temporal {
        Temporal::Whole => "whole clip".to_owned(),
        Temporal::While if intervals == [format!("0–{LAST_FRAME}")] => "while: all the time".to_owned(),
        Temporal::While => format!("while {}", intervals.join(", ")),
    }
}

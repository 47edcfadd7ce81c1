//! CVAT's own XML, "CVAT for images 1.1": polygons, boxes and masks of all pictures of a task.

use std::path::Path;

use l4d_data::DataError;
use l4d_data::error::inert;
use l4d_data::store::read_bounded;
use l4d_frames::Mask;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::fill::{Rule, fill};
use super::{AnnotatedObject, AnnotatedPicture, Annotations, check_size};

const MAX_BYTES: u64 = 512 << 20;
const REMEDY: &str = "export the task as \"CVAT for images 1.1\"";

/// Reads a file. Pixels of polygons and boxes belong if their centre lies inside.
pub fn read(path: &Path) -> Result<Annotations, DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let mut reader = Reader::from_reader(bytes.as_slice());
    let mut annotations = Annotations::default();
    loop {
        let position = reader.buffer_position();
        let place = Place { path, position };
        let event = reader.read_event().map_err(|error| place.wrong(error.to_string()))?;
        match event {
            Event::Eof => break,
            Event::Start(tag) | Event::Empty(tag) => start(&place, &tag, &mut annotations)?,
            _ => {}
        }
    }
    if annotations.pictures.is_empty() {
        let place = Place { path, position: 0 };
        return Err(place.wrong("holds no `image`".to_owned()));
    }
    Ok(annotations)
}

fn start(place: &Place<'_>, tag: &BytesStart<'_>, annotations: &mut Annotations) -> Result<(), DataError> {
    let name = String::from_utf8_lossy(tag.local_name().as_ref()).into_owned();
    match name.as_str() {
        "image" => {
            let (width, height) = (place.number(tag, "width")?, place.number(tag, "height")?);
            check_size(place.path, &format!("byte {}", place.position), width, height)?;
            let file_name = place.text(tag, "name")?;
            annotations.pictures.push(AnnotatedPicture { file_name, width, height, objects: Vec::new() });
        }
        "track" => {
            return Err(place.wrong("holds tracks of a video, whose frames are no pictures".to_owned()));
        }
        "polygon" | "box" | "mask" => {
            let picture = annotations.pictures.last_mut();
            let picture =
                picture.ok_or_else(|| place.wrong(format!("`{name}` stands outside of an image")))?;
            let (width, height) = (picture.width, picture.height);
            let mask = match name.as_str() {
                "polygon" => fill(Rule::Centres, &place.points(tag)?, width, height),
                "box" => fill(Rule::Centres, &place.corners(tag)?, width, height),
                _ => place.runs(tag, width, height)?,
            };
            let group = place.optional(tag, "group_id")?.and_then(|text| text.parse().ok());
            picture.objects.push(AnnotatedObject { label: place.text(tag, "label")?, group, mask });
        }
        "polyline" | "points" | "ellipse" | "cuboid" | "skeleton" => {
            let picture = annotations.pictures.last().map_or("", |picture| picture.file_name.as_str());
            annotations.notes.push(format!("{}: a `{name}` is no area and is left out", inert(picture)));
        }
        _ => {}
    }
    Ok(())
}

/// Where a tag stands, for errors.
struct Place<'a> {
    path: &'a Path,
    position: u64,
}

impl Place<'_> {
    fn wrong(&self, message: String) -> DataError {
        DataError::invalid(self.path, format!("byte {}", self.position), inert(&message), REMEDY)
    }

    fn optional(&self, tag: &BytesStart<'_>, name: &str) -> Result<Option<String>, DataError> {
        let attribute = tag.try_get_attribute(name).map_err(|error| self.wrong(error.to_string()))?;
        let Some(attribute) = attribute else { return Ok(None) };
        let raw = std::str::from_utf8(&attribute.value).map_err(|error| self.wrong(error.to_string()))?;
        let text = quick_xml::escape::unescape(raw).map_err(|error| self.wrong(error.to_string()))?;
        Ok(Some(text.into_owned()))
    }

    fn text(&self, tag: &BytesStart<'_>, name: &str) -> Result<String, DataError> {
        self.optional(tag, name)?.ok_or_else(|| self.wrong(format!("attribute `{name}` is missing")))
    }

    fn number<T: std::str::FromStr>(&self, tag: &BytesStart<'_>, name: &str) -> Result<T, DataError> {
        let text = self.text(tag, name)?;
        text.trim()
            .parse()
            .ok()
            .ok_or_else(|| self.wrong(format!("attribute `{name}` is `{text}`, which is no such number")))
    }

    /// `x,y;x,y;...`
    fn points(&self, tag: &BytesStart<'_>) -> Result<Vec<[f64; 2]>, DataError> {
        let text = self.text(tag, "points")?;
        let point = |pair: &str| {
            let (x, y) = pair.split_once(',')?;
            Some([x.trim().parse().ok()?, y.trim().parse().ok()?])
        };
        let points: Option<Vec<[f64; 2]>> = text.split(';').map(point).collect();
        points.ok_or_else(|| self.wrong("attribute `points` is not `x,y;x,y;...`".to_owned()))
    }

    fn corners(&self, tag: &BytesStart<'_>) -> Result<Vec<[f64; 2]>, DataError> {
        let (left, top): (f64, f64) = (self.number(tag, "xtl")?, self.number(tag, "ytl")?);
        let (right, bottom): (f64, f64) = (self.number(tag, "xbr")?, self.number(tag, "ybr")?);
        Ok(vec![[left, top], [right, top], [right, bottom], [left, bottom]])
    }

    /// Run lengths along the rows of a box, outside first.
    fn runs(&self, tag: &BytesStart<'_>, width: u32, height: u32) -> Result<Mask, DataError> {
        let (left, top): (u32, u32) = (self.number(tag, "left")?, self.number(tag, "top")?);
        let (box_width, box_height): (u32, u32) = (self.number(tag, "width")?, self.number(tag, "height")?);
        let fits = left.checked_add(box_width).is_some_and(|end| end <= width)
            && top.checked_add(box_height).is_some_and(|end| end <= height);
        if !fits || box_width == 0 {
            return Err(self.wrong("the box of a mask leaves the picture".to_owned()));
        }
        let text = self.text(tag, "rle")?;
        let runs: Option<Vec<u32>> = text.split(',').map(|run| run.trim().parse().ok()).collect();
        let runs =
            runs.ok_or_else(|| self.wrong("attribute `rle` holds something that is no number".to_owned()))?;
        let pixels = box_width * box_height;
        let total = runs.iter().try_fold(0_u32, |total, &run| total.checked_add(run));
        if total.is_none_or(|total| total > pixels) {
            return Err(self.wrong("attribute `rle` covers more than its box".to_owned()));
        }
        let mut mask = Mask::empty(width, height);
        let mut start = 0;
        for (index, run) in runs.iter().enumerate() {
            for pixel in (start..start + run).filter(|_| index % 2 == 1) {
                mask.set(left + pixel % box_width, top + pixel / box_width, true);
            }
            start += run;
        }
        Ok(mask)
    }
}

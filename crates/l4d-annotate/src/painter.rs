//! Frames on disk to pictures on the screen. Slow by nature: [`crate::paint_thread`] runs it beside the keyboard.

use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::UVec2;
use l4d_data::{DataError, Name};
use l4d_frames::closeup::Closeup;
use l4d_frames::overlay::Mark;
use l4d_frames::sheet::save;
use l4d_masks::mask::PixelBox;
use lru::LruCache;
use ratatui::layout::{Position, Size};
use ratatui_image::Resize;
use ratatui_image::picker::Picker;

use crate::art;
use crate::decoder::{Decoder, FrameKey, Shown};
use crate::error::in_full;
use crate::look::{Colours, Look};
use crate::picture::{Art, ExportRequest, Label, Picture, PictureRequest};
use crate::scene::{SceneInfo, Scenes};

/// Decoded frames that are kept: a whole clip from several views for `small`, a clip for `full`.
const FRAME_BUDGET_BYTES: usize = 256 << 20;
/// Painted pictures that are kept.
const KEPT_PICTURES: NonZeroUsize = NonZeroUsize::new(48).expect("48 is not zero");
/// Pixels of the kept pictures where the terminal keeps them as well; kitty throws the oldest away beyond 320 MB.
const PIXEL_BUDGET_BYTES: usize = 192 << 20;
/// Exported pictures are enlarged by a whole factor until they are about this wide, pixels.
const EXPORT_WIDTH_PX: u32 = 1024;
const EXPORT_LETTER_PX: f32 = 22.0;
/// Instances of fewer cells than this in depth have their number above instead of on them.
const ROOM_FOR_LABEL_CELLS: f32 = 0.8;

/// Decodes, scales, outlines and encodes.
pub(crate) struct Painter {
    exports: PathBuf,
    scenes: Arc<Scenes>,
    look: Look,
    picker: Option<Picker>,
    decoder: Decoder,
    frames: LruCache<FrameKey, Arc<Shown>>,
    pictures: LruCache<PictureRequest, Arc<Picture>>,
}

impl Painter {
    /// `data` holds the rendered scenes, `exports` receives pictures; `picker` encodes pixels, if they are shown.
    pub(crate) fn new(
        data: &Path,
        exports: &Path,
        scenes: Arc<Scenes>,
        look: Look,
        picker: Option<Picker>,
    ) -> Self {
        let largest = scenes.values().map(|card| card.size.element_product() as usize).max().unwrap_or(1);
        let bytes_each = largest * (size_of::<[u8; 3]>() + size_of::<u32>());
        let kept_frames = (FRAME_BUDGET_BYTES / bytes_each.max(1)).clamp(4, 2048);
        Self {
            decoder: Decoder::new(data),
            exports: exports.to_owned(),
            scenes,
            look,
            picker,
            frames: LruCache::new(NonZeroUsize::new(kept_frames).unwrap_or(KEPT_PICTURES)),
            pictures: LruCache::new(KEPT_PICTURES),
        }
    }

    pub(crate) fn recall(&mut self, request: &PictureRequest) -> Option<Arc<Picture>> {
        self.pictures.get(request).map(Arc::clone)
    }

    /// Decodes a frame, or finds it among the decoded ones.
    ///
    /// # Errors
    /// The frame cannot be read.
    pub(crate) fn frame(&mut self, key: &FrameKey) -> Result<Arc<Shown>, DataError> {
        if let Some(shown) = self.frames.get(key) {
            return Ok(Arc::clone(shown));
        }
        let card = self.card(&key.0)?;
        let shown = Arc::new(self.decoder.decode(&card, key)?);
        self.frames.put(key.clone(), Arc::clone(&shown));
        Ok(shown)
    }

    /// Paints a decoded frame.
    ///
    /// # Errors
    /// The pixels cannot be encoded for the terminal.
    pub(crate) fn paint(&mut self, request: &PictureRequest, shown: &Shown) -> Result<Arc<Picture>, String> {
        let card = self.card(&request.scene).map_err(|error| in_full(&error))?;
        let art = match &self.picker {
            Some(picker) => pixels(request, shown, &card, &self.look, picker)?,
            None => characters(request, shown, &card, &self.look),
        };
        if let Some(picker) = &self.picker {
            self.pictures.resize(kept_pictures(request.cells, picker));
        }
        let picture = Arc::new(Picture { request: request.clone(), source: Arc::clone(&shown.ids), art });
        self.pictures.put(request.clone(), Arc::clone(&picture));
        Ok(picture)
    }

    /// Writes a whole picture with outlines and numbers; gives its path.
    ///
    /// # Errors
    /// The frame cannot be read, or the file not be written.
    pub(crate) fn export(&mut self, request: &ExportRequest) -> Result<PathBuf, DataError> {
        let card = self.card(&request.scene)?;
        let shown = self.frame(&(request.scene.clone(), request.view.clone(), request.frame))?;
        let factor = EXPORT_WIDTH_PX.div_ceil(card.size.x.max(1)).max(1);
        let mut closeup = Closeup::cut(&shown.picture, &shown.ids.ids, whole(card.size), card.size * factor);
        let marks = marks(&card, &request.chosen, &self.look);
        closeup.outline(&marks, |mark| if request.chosen.contains(&mark.id) { 4 } else { 2 });
        closeup.write_numbers(&marks, EXPORT_LETTER_PX);
        let path = self.exports.join(&request.file_name);
        save(closeup.picture(), &path)?;
        Ok(path)
    }

    fn card(&self, scene: &Name) -> Result<SceneInfo, DataError> {
        self.scenes.get(scene).cloned().ok_or_else(|| {
            let hint = "this is a fault of l4d: please report it";
            DataError::invalid(self.decoder.data(), "scene", format!("{scene} is not one of the round"), hint)
        })
    }
}

fn kept_pictures(cells: Size, picker: &Picker) -> NonZeroUsize {
    let font = picker.font_size();
    let pixels = cells.area() as usize * usize::from(font.width) * usize::from(font.height);
    let count = PIXEL_BUDGET_BYTES / (pixels * size_of::<[u8; 4]>()).max(1);
    NonZeroUsize::new(count.min(KEPT_PICTURES.get())).unwrap_or(NonZeroUsize::MIN)
}

/// What is chosen is outlined in white, which no number has.
fn marks(card: &SceneInfo, chosen: &BTreeSet<u32>, look: &Look) -> Vec<Mark> {
    let mut marks = card.marks();
    for mark in &mut marks {
        if look.colours == Colours::None || chosen.contains(&mark.id) {
            mark.colour.0 = [255; 3];
        }
    }
    marks
}

fn whole(size: UVec2) -> PixelBox {
    PixelBox { first_col: 0, first_row: 0, last_col: size.x - 1, last_row: size.y - 1 }
}

fn cut(request: &PictureRequest, shown: &Shown, look: &Look, (wide, high): (u32, u32)) -> Closeup {
    let Size { width, height } = request.cells;
    let size = UVec2::new(u32::from(width) * wide, u32::from(height) * high);
    let mut closeup = Closeup::cut(&shown.picture, &shown.ids.ids, request.region, size);
    if look.colours == Colours::None {
        closeup.remove_colour();
    }
    closeup
}

fn characters(request: &PictureRequest, shown: &Shown, card: &SceneInfo, look: &Look) -> Art {
    let grain = art::grain(look);
    let mut closeup = cut(request, shown, look, grain);
    let mut labels = Vec::new();
    if request.outlines {
        labels = place_labels(&closeup, card, request.cells, grain);
        closeup.outline(&marks(card, &request.chosen, look), |_| 1);
    }
    Art::Cells { cells: art::cells(&closeup, look), labels }
}

fn pixels(
    request: &PictureRequest,
    shown: &Shown,
    card: &SceneInfo,
    look: &Look,
    picker: &Picker,
) -> Result<Art, String> {
    let font = picker.font_size();
    let mut closeup = cut(request, shown, look, (u32::from(font.width), u32::from(font.height)));
    if request.outlines {
        let line_px = u32::from(font.height / 10).max(1);
        let marks = marks(card, &request.chosen, look);
        closeup.outline(&marks, |mark| if request.chosen.contains(&mark.id) { 2 * line_px } else { line_px });
        closeup.write_numbers(&marks, f32::from(font.height) * 0.9);
    }
    let protocol = picker.new_protocol(closeup.into_picture().into(), request.cells, Resize::Fit(None));
    protocol.map(|protocol| Art::Pixels(Box::new(protocol))).map_err(|error| error.to_string())
}

/// A cell for each visible object's number: on the object if it is large enough, else above it, and never on
/// another number.
fn place_labels(closeup: &Closeup, card: &SceneInfo, cells: Size, (wide, high): (u32, u32)) -> Vec<Label> {
    let mut labels: Vec<Label> = Vec::new();
    for object in &card.objects {
        let Some(anchor) = closeup.anchor(object.id) else { continue };
        let half_width = object.number.to_string().len() as u16 / 2;
        let column = (anchor.pixel.x / wide) as u16;
        let is_large = anchor.depth / high as f32 >= ROOM_FOR_LABEL_CELLS;
        let row = if is_large { anchor.pixel.y / high } else { (anchor.top / high).saturating_sub(1) } as u16;
        let free = |at: Position| {
            labels.iter().all(|other| other.at.y != at.y || other.at.x.abs_diff(at.x) > 3 + half_width)
        };
        let tries = [(0, 0), (0, -1), (0, 1), (-4, 0), (4, 0), (0, -2), (0, 2), (-4, -1), (4, -1)];
        let places = tries.map(|(right, down)| {
            let x = (i32::from(column) + right).clamp(1, i32::from(cells.width) - 2);
            let y = (i32::from(row) + down).clamp(0, i32::from(cells.height) - 1);
            Position::new(x.max(0) as u16, y.max(0) as u16)
        });
        let at = places.into_iter().find(|&at| free(at)).unwrap_or(places[0]);
        labels.push(Label { number: object.number, id: object.id, at });
    }
    labels
}

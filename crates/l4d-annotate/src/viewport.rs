//! Which part of a picture is on the screen.

use glam::{DVec2, UVec2};
use l4d_masks::mask::PixelBox;

/// Largest enlargement: beyond it single pixels fill the screen.
const MAX_ZOOM: f64 = 12.0;
/// One press of a zoom key.
const ZOOM_STEP: f64 = 1.5;
/// Share of the shown part that stays empty around what was zoomed to, on each side.
const AIR: f64 = 0.3;

/// A centre, as fractions of the picture's sides, and how much larger than the whole picture things appear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Viewport {
    centre: DVec2,
    zoom: f64,
}

impl Viewport {
    /// The whole picture.
    pub(crate) const WHOLE: Self = Self { centre: DVec2::splat(0.5), zoom: 1.0 };

    /// Whether everything is shown.
    pub(crate) fn is_whole(self) -> bool {
        self.zoom == 1.0
    }

    pub(crate) fn zoom(self) -> f64 {
        self.zoom
    }

    /// The shown pixels of a picture.
    pub(crate) fn region(self, picture: UVec2) -> PixelBox {
        let extent = (picture.as_dvec2() / self.zoom).round().max(DVec2::ONE).as_uvec2();
        let corner = (self.centre * picture.as_dvec2() - extent.as_dvec2() / 2.0).round();
        let first = corner.clamp(DVec2::ZERO, (picture - extent).as_dvec2()).as_uvec2();
        let last = first + extent - 1;
        PixelBox { first_col: first.x, first_row: first.y, last_col: last.x, last_row: last.y }
    }

    /// Zooms by steps, in when positive; the middle stays in its place.
    #[must_use]
    pub(crate) fn zoomed(self, steps: i32) -> Self {
        Self { zoom: (self.zoom * ZOOM_STEP.powi(steps)).clamp(1.0, MAX_ZOOM), ..self }.clamped()
    }

    /// Moves by fractions of the shown part.
    #[must_use]
    pub(crate) fn panned(self, by: DVec2) -> Self {
        Self { centre: self.centre + by / self.zoom, ..self }.clamped()
    }

    /// Shows a box of pixels with some air around it.
    pub(crate) fn onto(found: PixelBox, picture: UVec2) -> Self {
        let first = UVec2::new(found.first_col, found.first_row).as_dvec2();
        let last = UVec2::new(found.last_col, found.last_row).as_dvec2() + 1.0;
        let share = (last - first) / picture.as_dvec2();
        let zoom = (1.0 - 2.0 * AIR).max(0.1) / share.max_element().max(1e-3);
        let centre = (first + last) / 2.0 / picture.as_dvec2();
        Self { centre, zoom: zoom.clamp(1.0, MAX_ZOOM) }.clamped()
    }

    /// Keeps the shown part inside the picture.
    fn clamped(self) -> Self {
        let zoom = if self.zoom < 1.01 { 1.0 } else { self.zoom };
        let reach = DVec2::splat(0.5 / zoom);
        Self { centre: self.centre.clamp(reach, 1.0 - reach), zoom }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PICTURE: UVec2 = UVec2::new(256, 192);

    fn corners(view: Viewport) -> [u32; 4] {
        let region = view.region(PICTURE);
        [region.first_col, region.first_row, region.last_col, region.last_row]
    }

    #[test]
    fn the_whole_picture_is_the_whole_picture() {
        assert_eq!(corners(Viewport::WHOLE), [0, 0, 255, 191]);
    }

    #[test]
    fn zooming_keeps_the_middle_and_panning_stops_at_the_edge() {
        // 256 / 2.25 = 113.8, 192 / 2.25 = 85.3
        assert_eq!(corners(Viewport::WHOLE.zoomed(2)), [71, 54, 184, 138]);
        assert_eq!(Viewport::WHOLE.zoomed(2).zoomed(-9), Viewport::WHOLE);
        assert_eq!(Viewport::WHOLE.zoomed(99).zoom(), MAX_ZOOM);
        // 256 / 1.5 = 170.7, 192 / 1.5 = 128
        assert_eq!(corners(Viewport::WHOLE.zoomed(1).panned(DVec2::new(9.0, -9.0))), [85, 0, 255, 127]);
        assert_eq!(Viewport::WHOLE.panned(DVec2::ONE), Viewport::WHOLE);
    }

    #[test]
    fn zooming_onto_a_box_centres_it() {
        let found = PixelBox { first_col: 118, first_row: 86, last_col: 137, last_row: 105 };
        let region = Viewport::onto(found, PICTURE).region(PICTURE);
        assert!(
            region.first_col < 118 && region.last_col > 137 && region.first_row < 86 && region.last_row > 105
        );
        // The box is centred between columns 127 and 128; so is the region, give or take the rounding.
        assert!((region.first_col + region.last_col).abs_diff(118 + 137) <= 1, "{region:?}");
        let all = PixelBox { first_col: 0, first_row: 0, last_col: 255, last_row: 191 };
        assert_eq!(Viewport::onto(all, PICTURE), Viewport::WHOLE);
    }
}

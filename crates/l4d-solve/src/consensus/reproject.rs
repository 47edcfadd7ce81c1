//! A mask of one view as another view would see it (the paper's projection of m_i into j), and how much of it the
//! other view can see at all.
//!
//! A point is hidden in a view that shows something nearer there, by more than the tolerance. Refuses to know what
//! anybody says about the mask.

use l4d_masks::Mask;

use super::settings::ReprojectionSettings;
use super::view_geometry::{Surface, ViewGeometry, centre, pixel_at};

/// The other view is asked this far around where the marked points land, pixels: neighbouring points of one surface
/// may land that far apart.
const MARGIN_PX: u32 = 2;

/// A mask in another view.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Reprojection {
    /// Marked pixels that have a depth.
    pub(super) projected: u64,
    /// Those whose point lies within the other picture.
    pub(super) in_frame: u64,
    /// Those of them that nothing hides there.
    pub(super) passing: u64,
    /// The pixels of the other picture that show the marked surface.
    pub(super) covered: Mask,
}

/// Carries a mask from one view to another: each pixel of the other view near where the marked points land asks whether
/// the point that it shows is marked.
pub(super) fn reproject(
    from: &ViewGeometry,
    mask: &Mask,
    to: &ViewGeometry,
    settings: &ReprojectionSettings,
) -> Reprojection {
    let size = to.size();
    let there = from.warp_to(to);
    let mut result =
        Reprojection { projected: 0, in_frame: 0, passing: 0, covered: Mask::empty(size.0, size.1) };
    let mut landed = LandingBox::default();
    for (column, row) in mask.pixels() {
        let Some(surface) = from.surface(column, row) else { continue };
        result.projected += 1;
        let Some((position, depth_m)) = there.apply(centre(column, row), surface.depth_m) else { continue };
        let Some(pixel) = pixel_at(size, position) else { continue };
        result.in_frame += 1;
        landed.add(pixel);
        let point = Point { view: from, surface, depth_m };
        result.passing += u64::from(!point.is_hidden(to, pixel, settings));
    }

    let back = to.warp_to(from);
    for (column, row) in landed.pixels(size) {
        let Some(surface) = to.surface(column, row) else { continue };
        let Some((position, depth_m)) = back.apply(centre(column, row), surface.depth_m) else { continue };
        let Some(pixel) = pixel_at(from.size(), position) else { continue };
        if !mask.get(pixel.0, pixel.1) {
            continue;
        }
        let Some(marked) = from.surface(pixel.0, pixel.1) else { continue };
        let point = Point { view: to, surface, depth_m };
        if point.is_within((depth_m - marked.depth_m).abs(), from, marked, settings) {
            result.covered.set(column, row, true);
        }
    }
    result
}

/// Pixels in which points landed.
#[derive(Debug, Clone, Copy, Default)]
struct LandingBox {
    corners: Option<[(u32, u32); 2]>,
}

impl LandingBox {
    fn add(&mut self, (column, row): (u32, u32)) {
        let [first, last] = self.corners.unwrap_or([(column, row); 2]);
        self.corners = Some([(first.0.min(column), first.1.min(row)), (last.0.max(column), last.1.max(row))]);
    }

    /// The pixels of the box and around it.
    fn pixels(self, (width, height): (u32, u32)) -> impl Iterator<Item = (u32, u32)> {
        let [first, last] = self.corners.unwrap_or([(1, 1), (0, 0)]);
        let columns = first.0.saturating_sub(MARGIN_PX)..(last.0 + MARGIN_PX + 1).min(width);
        let rows = first.1.saturating_sub(MARGIN_PX)..(last.1 + MARGIN_PX + 1).min(height);
        let has_any = self.corners.is_some();
        rows.filter(move |_| has_any).flat_map(move |row| columns.clone().map(move |column| (column, row)))
    }
}

/// A point that one view shows, seen from another.
#[derive(Debug, Clone, Copy)]
struct Point<'a> {
    view: &'a ViewGeometry<'a>,
    surface: Surface,
    /// From the other view, metres.
    depth_m: f64,
}

impl Point<'_> {
    /// Whether the other view shows something nearer. A pixel without depth shows nothing, and hides nothing.
    fn is_hidden(
        &self,
        other: &ViewGeometry,
        (column, row): (u32, u32),
        settings: &ReprojectionSettings,
    ) -> bool {
        let Some(shown) = other.surface(column, row) else { return false };
        !self.is_within(self.depth_m - shown.depth_m, other, shown, settings)
    }

    /// Whether a difference of depths (metres) from what the other view shows is within the tolerance.
    fn is_within(
        &self,
        difference_m: f64,
        other: &ViewGeometry,
        shown: Surface,
        settings: &ReprojectionSettings,
    ) -> bool {
        let excess_m = difference_m - settings.tolerance * self.depth_m;
        // Spreads are looked up where they decide: mostly they do not.
        excess_m <= 0.0
            || (settings.with_spread
                && excess_m <= settings.most_spread * self.depth_m
                && excess_m <= self.view.spread_m(self.surface) + other.spread_m(shown))
    }
}

//! A mask of one view as another view would see it (the paper's projection of m_i into j), and how much of it the
//! other view can see at all.
//!
//! A point is hidden in a view that shows something nearer there, by more than the tolerance. Refuses to know what
//! anybody says about the mask.

use glam::DVec2;
use l4d_masks::Mask;

use super::settings::{Method, ReprojectionSettings};
use super::view_geometry::{Surface, ViewGeometry, Warp, centre, pixel_at};

/// A footprint is cut at this many pixels a side: a marked pixel right in front of the other camera says nothing
/// about the rest of the picture.
const MOST_FOOTPRINT_PX: f64 = 32.0;
/// The other view is asked this far around where the marked points land, pixels: neighbouring points of one surface
/// may land that far apart.
const MARGIN_PX: u32 = 2;

/// A mask in another view.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reprojection {
    /// Marked pixels that have a depth.
    pub projected: u64,
    /// Those whose point lies within the other picture.
    pub in_frame: u64,
    /// Those of them that nothing hides there.
    pub passing: u64,
    /// The pixels of the other picture that show the marked surface.
    pub covered: Mask,
    /// Pixels that were looked at, in both pictures: what the work is proportional to.
    pub visited: u64,
}

/// Carries a mask from one view to another.
pub fn reproject(
    from: &ViewGeometry,
    mask: &Mask,
    to: &ViewGeometry,
    settings: &ReprojectionSettings,
) -> Reprojection {
    let size = to.size();
    let there = from.warp_to(to);
    let mut result = Reprojection {
        projected: 0,
        in_frame: 0,
        passing: 0,
        covered: Mask::empty(size.0, size.1),
        visited: 0,
    };
    let mut landed = LandingBox::default();
    for (column, row) in mask.pixels() {
        result.visited += 1;
        let Some(surface) = from.surface(column, row) else { continue };
        result.projected += 1;
        let Some((position, depth_m)) = there.apply(centre(column, row), surface.depth_m) else { continue };
        let Some(pixel) = pixel_at(size, position) else { continue };
        result.in_frame += 1;
        landed.add(pixel);
        let point = Point { view: from, surface, depth_m };
        result.passing += u64::from(!point.is_hidden(to, pixel, settings));
        if settings.method == Method::Footprint {
            let side = from.focal().recip() * to.focal() * (surface.depth_m / depth_m);
            cover_square(&mut result, position, side, &point, to, settings);
        }
    }
    if settings.method == Method::InverseWarp {
        ask(&mut result, landed, to, &to.warp_to(from), from, mask, settings);
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

/// Each pixel of the other view's box that shows a marked point is covered.
fn ask(
    result: &mut Reprojection,
    landed: LandingBox,
    to: &ViewGeometry,
    back: &Warp,
    from: &ViewGeometry,
    mask: &Mask,
    settings: &ReprojectionSettings,
) {
    for (column, row) in landed.pixels(to.size()) {
        result.visited += 1;
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
}

/// All pixels whose centre lies in the square (pixels, `side` wide and high) and which show nothing nearer.
fn cover_square(
    result: &mut Reprojection,
    position: DVec2,
    side: DVec2,
    point: &Point,
    to: &ViewGeometry,
    settings: &ReprojectionSettings,
) {
    let (width, height) = to.size();
    let half = side.min(DVec2::splat(MOST_FOOTPRINT_PX)).max(DVec2::ONE) / 2.0;
    // Half open, so that squares side by side share no pixel. Conversion saturates: nothing is left of 0.
    let first = (position - half - 0.5).ceil().max(DVec2::ZERO);
    let end = (position + half - 0.5).ceil();
    for row in first.y as u32..(end.y as u32).min(height) {
        for column in first.x as u32..(end.x as u32).min(width) {
            result.visited += 1;
            if !point.is_hidden(to, (column, row), settings) {
                result.covered.set(column, row, true);
            }
        }
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

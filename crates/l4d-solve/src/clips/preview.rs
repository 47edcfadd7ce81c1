//! All views of a clip side by side, colour above depth.

use l4d_data::{DataError, StageError};
use l4d_frames::drawn::RgbImage;
use l4d_frames::moving_picture::Pages;
use l4d_frames::preview::{Cell, Page};

use super::{ClipsFolder, Plan, Shot};

/// Pages of a moving picture.
pub struct Preview<'a> {
    folder: &'a ClipsFolder,
    plan: &'a Plan,
    page: Page,
}

impl<'a> Preview<'a> {
    /// Pages of about this width, with greys for the depths of the first moment.
    ///
    /// # Errors
    /// A picture that cannot be read.
    pub fn new(folder: &'a ClipsFolder, plan: &'a Plan, widest_px: u32) -> Result<Self, DataError> {
        let names = plan.cameras.iter().map(|camera| camera.name.to_string()).collect();
        let depths: Vec<f32> = cells(folder, plan, 0)?.into_iter().flat_map(|cell| cell.depth_m).collect();
        Ok(Self { folder, plan, page: Page::new(names, (plan.size[0], plan.size[1]), widest_px, depths) })
    }
}

impl Pages for Preview<'_> {
    fn size_px(&self) -> (u32, u32) {
        self.page.size_px()
    }

    fn page(&self, index: usize) -> Result<RgbImage, StageError> {
        Ok(self.page.draw(&cells(self.folder, self.plan, index)?))
    }
}

fn cells(folder: &ClipsFolder, plan: &Plan, instant: usize) -> Result<Vec<Cell>, DataError> {
    let cell = |view: usize| {
        let (colour, depth) = folder.read(plan, Shot { view, instant })?;
        Ok(Cell { colour, depth_m: depth.depth_m })
    };
    (0..plan.cameras.len()).map(cell).collect()
}

//! An answer at one moment: one number per Gaussian, and where its blend (paper, equation 3) is cut.
//!
//! Owns how answers become masks, one or many at once: whatever a lift learned, drawing it is a blend of one channel.
//! Refuses to know how the numbers came about.

use l4d_masks::Mask;
use l4d_splat::raster::Projected;
use l4d_splat::view::View;

use super::error::LiftError;

/// Answers blended by one walk over the picture.
const AT_ONCE: usize = 16;

/// What an answer says of the Gaussians at a time.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// One a Gaussian. Their blend says what a pixel shows.
    pub values: Vec<f32>,
    /// Pixels whose blend lies above this belong to the answer.
    pub cut: f32,
    /// Which Gaussians belong to the answer themselves, whatever pixels they are blended into.
    pub members: Vec<bool>,
}

impl Layer {
    /// The pixels of the answer in one view.
    ///
    /// # Errors
    /// A layer of other Gaussians than those that are drawn.
    pub fn mask(&self, projected: &dyn Projected, view: &View) -> Result<Mask, LiftError> {
        let blend = projected.splat_features(&self.values, 1)?;
        Ok(cut(&blend, 1, 0, self.cut, view))
    }
}

/// The pixels of many answers in one view, of which the Gaussians are projected and ordered once.
///
/// # Errors
/// As [`Layer::mask`].
pub fn masks(projected: &dyn Projected, view: &View, layers: &[&Layer]) -> Result<Vec<Mask>, LiftError> {
    let mut masks = Vec::with_capacity(layers.len());
    for some in layers.chunks(AT_ONCE) {
        let count = some.iter().map(|layer| layer.values.len()).max().unwrap_or_default();
        let mut values = vec![0.0; count * some.len()];
        for (channel, layer) in some.iter().enumerate() {
            for (row, &value) in values.chunks_exact_mut(some.len()).zip(&layer.values) {
                row[channel] = value;
            }
        }
        let blend = projected.splat_features(&values, some.len())?;
        let channels = some.iter().enumerate();
        masks.extend(channels.map(|(channel, layer)| cut(&blend, some.len(), channel, layer.cut, view)));
    }
    Ok(masks)
}

/// Pixels of one channel above a level.
pub(super) fn cut(blend: &[f32], channels: usize, channel: usize, level: f32, view: &View) -> Mask {
    let width = view.width() as usize;
    Mask::from_fn(view.width(), view.height(), |column, row| {
        let pixel = row as usize * width + column as usize;
        blend.get(pixel * channels + channel).is_some_and(|&value| value > level)
    })
}

//! The constants of splatting, as settings.

use super::RasterError;

/// How splats are projected and blended. The defaults are those of 3D Gaussian splatting, on which foreign
/// checkpoints were trained.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RasterSettings {
    /// What shows where nothing is, display colour.
    pub background: [f32; 3],
    /// Gaussians whose centre is not farther than this are not drawn, metres along the optical axis.
    pub near_m: f32,
    /// Added to both variances of a projected Gaussian, square pixels: none is thinner than about half a pixel.
    pub blur_px2: f32,
    /// Half side of the square of tiles in which a Gaussian is drawn, standard deviations of its longer axis.
    pub coverage_sigmas: f32,
    /// The affine approximation is taken no farther outside the picture than this multiple of its half field of
    /// view.
    pub frustum_margin: f32,
    /// Where alpha is below this a Gaussian leaves no trace.
    pub alpha_min: f32,
    /// Alpha is capped here; capped alpha has no gradient.
    pub alpha_max: f32,
    /// A pixel is finished by the first Gaussian that would leave less transmittance than this; that Gaussian is
    /// not blended.
    pub transmittance_min: f32,
    /// Whether drawings contain [`super::DepthQuantiles`]; training needs none.
    pub quantiles: bool,
}

impl Default for RasterSettings {
    fn default() -> Self {
        Self {
            background: [0.0; 3],
            near_m: 0.2,
            blur_px2: 0.3,
            coverage_sigmas: 3.0,
            frustum_margin: 1.3,
            alpha_min: 1.0 / 255.0,
            alpha_max: 0.99,
            transmittance_min: 1e-4,
            quantiles: true,
        }
    }
}

impl RasterSettings {
    /// Whether pictures can be drawn with these.
    ///
    /// # Errors
    /// The first setting out of range, by name.
    pub fn check(&self) -> Result<(), RasterError> {
        let ranges = [
            ("background", self.background[0], -1e6..=1e6, "colours are finite, below 1e6"),
            ("background", self.background[1], -1e6..=1e6, "colours are finite, below 1e6"),
            ("background", self.background[2], -1e6..=1e6, "colours are finite, below 1e6"),
            ("near_m", self.near_m, 1e-6..=1e6, "between 1e-6 and 1e6 metres"),
            ("blur_px2", self.blur_px2, 1e-3..=1e6, "between 0.001 and 1e6 square pixels"),
            ("coverage_sigmas", self.coverage_sigmas, 0.1..=1e3, "between 0.1 and 1000"),
            ("frustum_margin", self.frustum_margin, 1.0..=1e3, "between 1 and 1000"),
            // In f32 and with an exponential by parts, smaller values could not be told from 0.
            ("alpha_min", self.alpha_min, 1e-30..=0.5, "between 1e-30 and 0.5"),
            // The gradient divides by 1 - alpha.
            ("alpha_max", self.alpha_max, 0.5..=0.9999, "between 0.5 and 0.9999"),
            ("transmittance_min", self.transmittance_min, 0.0..=0.5, "between 0 and 0.5"),
        ];
        match ranges.into_iter().find(|(_, value, range, _)| !range.contains(value)) {
            Some((field, value, _, hint)) => {
                Err(RasterError::Invalid(format!("raster setting `{field}` is {value}: {hint}")))
            }
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_can_be_drawn_with_and_other_values_are_named() {
        assert!(RasterSettings::default().check().is_ok());
        let with = |change: fn(&mut RasterSettings)| {
            let mut settings = RasterSettings::default();
            change(&mut settings);
            settings.check().unwrap_err().to_string()
        };
        assert!(with(|s| s.near_m = 0.0).contains("`near_m` is 0"));
        assert!(with(|s| s.alpha_max = 1.0).contains("`alpha_max` is 1"));
        assert!(with(|s| s.background[2] = f32::NAN).contains("`background` is NaN"));
        assert!(with(|s| s.transmittance_min = -1e-9).contains("`transmittance_min`"));
    }
}

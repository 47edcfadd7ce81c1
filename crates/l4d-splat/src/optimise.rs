//! How parameters follow from errors: losses and penalties with their gradients, learning rates, and Adam.
//!
//! Everything here is a function of lists of numbers. It refuses to know what the lists mean to a scene, where
//! pictures come from and when training is done. Losses return their value and *add* their gradient, times a weight,
//! to a list that the caller owns, so that terms sum up without copies. A number that is not finite anywhere in the
//! input is an error that names it, and whatever would have been written is then as it was.

mod adam;
mod depth;
mod error;
mod finite;
mod l1;
mod planes;
mod rate;
mod rates;
mod ssim;

pub use adam::{Adam, Group, GroupUpdate, Moments};
pub use depth::{DepthGradient, RenderedDepth, depth_l1};
pub use error::OptimiseError;
pub use l1::l1;
pub use planes::{PlanePenalty, PlaneWeights, plane_penalty};
pub use rate::LearningRate;
pub use rates::{Rates, sh_pattern};
pub use ssim::{SSIM_WINDOW, dssim};

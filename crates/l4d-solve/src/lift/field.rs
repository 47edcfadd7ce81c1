//! The temporal identity field (paper, section 4, equations 2 to 6; after SA4D).
//!
//! e = phi(gamma(X), gamma(t)) for each Gaussian, E = sum over Gaussians of e a T in each pixel, f = softmax of a 1x1
//! convolution of E over C = 2 classes; cross-entropy on the masks and a KL divergence that holds neighbours in the
//! deformed space together.
//!
//! The same numbers are reached by a shorter way than they are written down (docs/panopticquery.md lists the
//! savings): a convolution commutes with a blend and two classes need one number, the difference of their logits, so
//! that one channel is drawn and not 32; the last layer and the convolution are one vector; phi is evaluated once an
//! iteration, for the Gaussians that the picture or the neighbourhoods need; neighbours are found once a time. `literal` in
//! the tests writes the objective down as the paper does, and both learn alike.

mod active;
mod encoding;
mod init;
mod learn;
#[cfg(test)]
mod literal;
mod network;
mod objective;
mod settings;
#[cfg(test)]
mod tests;

use l4d_splat::tensor::Tensor;
use rayon::prelude::*;

use super::layer::Layer;
use encoding::Places;
use network::{Collapsed, Scratch};

pub(super) use learn::{distil, learn};
pub use network::Network;
pub use settings::{DistilSettings, FieldSettings, Normalisation, ReadOut};

/// Gaussians evaluated together: enough for the matrix products to run at full speed.
pub(super) const BLOCK_ROWS: usize = 256;

/// A trained field and how it is read out.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// The parameters.
    pub network: Network,
    /// How its features become masks.
    pub read_out: ReadOut,
}

impl Field {
    /// Difference of the two classes' logits of Gaussians with these canonical centres (metres) at a time from 0 to
    /// 1, without the convolution's bias: above minus [`Self::bias`] a Gaussian belongs to the answer.
    pub fn logits(&self, means: &[[f32; 3]], time: f32) -> Vec<f32> {
        let places = Places::new(means);
        let collapsed = Collapsed::new(&self.network, time);
        let mut logits = vec![0.0; means.len()];
        let rows: Vec<u32> = (0..means.len() as u32).collect();
        rows.par_chunks(BLOCK_ROWS).zip(logits.par_chunks_mut(BLOCK_ROWS)).for_each_init(
            Scratch::default,
            |scratch, (rows, logits)| {
                collapsed.logits(&self.network, &places, rows, scratch, logits);
            },
        );
        logits
    }

    /// What the convolution adds to the difference of the logits, in every pixel and for every Gaussian.
    pub fn bias(&self) -> f32 {
        self.network.bias()
    }

    pub(super) fn layer(&self, means: &[[f32; 3]], time: f32) -> Layer {
        let (logits, bias) = (self.logits(means, time), self.bias());
        let members: Vec<bool> = logits.iter().map(|logit| logit + bias > 0.0).collect();
        match self.read_out {
            // softmax(conv(E)) is largest for the answer where the blend of the logits is above minus the bias.
            ReadOut::Decode2d => Layer { values: logits, cut: -bias, members },
            ReadOut::Hard3d => {
                let values = members.iter().map(|&member| f32::from(u8::from(member))).collect();
                Layer { values, cut: super::labels::HALF, members }
            }
        }
    }

    /// The parameters by name.
    pub(super) fn tensors(&self) -> Vec<(&'static str, Tensor)> {
        self.network.tensors()
    }
}

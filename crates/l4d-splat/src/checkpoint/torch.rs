//! Gaussians in files of `torch.save`: what gsplat's trainer, 3DGS, 4DGaussians and 4D LangSplat go on training from.

use std::collections::BTreeMap;

use l4d_formats::pickle::{self, Contents, Step};
use l4d_formats::{Fault, Tensor};

use super::check_gaussians;
use crate::gaussians::{Gaussians, ShDegree};

const HINT: &str = "give a checkpoint of gsplat's simple_trainer (`ckpt_*.pt`), of 3DGS, 4DGaussians or 4D LangSplat \
                      (`chkpnt*.pth`), or a PLY of 3DGS";

/// What such a file holds.
pub(crate) struct Saved {
    pub(crate) gaussians: Gaussians,
    /// Degree of the harmonics that training had reached, where it says so.
    pub(crate) active: Option<ShDegree>,
    /// Steps of training, where it says so.
    pub(crate) iteration: u32,
    /// Parameters of a deformation field, and of what nothing computes with; none of static Gaussians.
    pub(crate) field: Option<BTreeMap<String, Tensor>>,
}

/// Gaussians, and the parameters of a field where there is one.
pub(crate) fn decode(bytes: &[u8]) -> Result<Saved, Fault> {
    use Step::{Entry, Item};
    let file = pickle::open(bytes)?;
    if file.is_dict(&[Entry("splats")]) {
        let splats = [Entry("splats")];
        let tensor = |name: &str| tensor(&file, &[splats[0], Entry(name)]);
        let lists = [tensor("means")?, tensor("scales")?, tensor("quats")?, tensor("opacities")?];
        let gaussians = gaussians(lists, &tensor("sh0")?, &tensor("shN")?)?;
        return Ok(Saved { gaussians, active: None, iteration: 0, field: None });
    }
    // `(parameters, iteration)`: 12 parameters of 3DGS; a field and a table before the harmonics of 4DGaussians; language
    // features behind the opacity of 4D LangSplat.
    let first = match (file.items(&[]), file.items(&[Item(0)])) {
        (Some(2), Some(12)) => 2,
        (Some(2), Some(14 | 15)) if file.is_dict(&[Item(0), Item(2)]) => 4,
        _ => return Err(Fault::new("top level", "is no checkpoint of Gaussians", HINT)),
    };
    let tensor = |place: usize| tensor(&file, &[Item(0), Item(place)]);
    let [sh0, rest, log_scales, rotations, opacities] = [0, 1, 2, 3, 4].map(|next| tensor(first + next));
    let lists = [tensor(1)?, log_scales?, rotations?, opacities?];
    let active =
        file.number(&[Item(0), Item(0)]).and_then(|degree| ShDegree::new(u8::try_from(degree).ok()?));
    let field = match first {
        4 => Some(file.saved(&[Item(0), Item(2)])?.into_state_dict()?),
        _ => None,
    };
    let iteration = file.number(&[Item(1)]).and_then(|steps| u32::try_from(steps).ok()).unwrap_or(0);
    Ok(Saved { gaussians: gaussians(lists, &sh0?, &rest?)?, active, iteration, field })
}

fn tensor(file: &Contents<'_>, path: &[Step<'_>]) -> Result<Tensor, Fault> {
    file.saved(path)?.into_tensor()
}

/// Lists of centres, log-scales, rotations and opacity logits, and harmonics [N, coefficients, 3].
fn gaussians(lists: [Tensor; 4], sh0: &Tensor, rest: &Tensor) -> Result<Gaussians, Fault> {
    let count = sh0.data.len() / 3;
    let odd = |what: &str, tensor: &Tensor| {
        Fault::new(what, format!("has the shape {:?} for {count} Gaussians", tensor.shape), HINT)
    };
    let widths = [3, 3, 4, 1];
    let names = ["the centres", "the scales", "the rotations", "the opacities"];
    for ((tensor, width), name) in lists.iter().zip(widths).zip(names) {
        if tensor.data.len() != count * width {
            return Err(odd(name, tensor));
        }
    }
    let higher = rest.data.len() / (3 * count.max(1));
    let sh_degree = (0..=ShDegree::MAX.get()).filter_map(ShDegree::new);
    let sh_degree = sh_degree.into_iter().find(|degree| degree.coefficients() == higher + 1);
    let sh_degree = sh_degree.filter(|_| rest.data.len() == count * higher * 3);
    let sh_degree = sh_degree.ok_or_else(|| odd("the higher harmonics", rest))?;
    let [means, log_scales, rotations, opacities] = lists;
    let rest = rest.data.as_chunks::<3>().0;
    let of_each = |(index, constant): (usize, &[f32; 3])| {
        std::iter::once(*constant).chain(rest[index * higher..][..higher].iter().copied()).collect::<Vec<_>>()
    };
    let gaussians = Gaussians {
        sh_degree,
        means: means.data.as_chunks().0.to_vec(),
        log_scales: log_scales.data.as_chunks().0.to_vec(),
        rotations: rotations.data.as_chunks().0.to_vec(),
        opacity_logits: opacities.data,
        sh: sh0.data.as_chunks::<3>().0.iter().enumerate().flat_map(of_each).collect(),
    };
    check_gaussians(&gaussians)?;
    Ok(gaussians)
}

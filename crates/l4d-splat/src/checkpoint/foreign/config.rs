//! Sizes and switches of a field: those that shapes show, and those that only `cfg_args` knows.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::read_bounded;
use l4d_formats::fault::quoted;
use l4d_formats::python::{Literal, namespace};
use l4d_formats::{Fault, Tensor};

use crate::checkpoint::HINT_PAIR;
use crate::deform::{DeformConfig, PREFIX, TimeAxis, plane_name};

/// No `cfg_args` is longer, bytes: real ones have about 3000.
const MAX_OPTIONS_BYTES: u64 = 1 << 16;
/// Levels of planes, and how much finer one may be than the first: four and 8 in the original.
const MOST_LEVELS: usize = 16;
const LARGEST_MULTIPLIER: u32 = 1024;

const HINT_UNSUPPORTED: &str = "train without this option: no configuration of the original uses it";

/// The configuration of the field whose parameters are `tensors`.
///
/// Sizes come from the shapes of the parameters, multipliers and switches from the options.
pub(super) fn derive(options: &Options, tensors: &BTreeMap<String, Tensor>) -> Result<DeformConfig, Fault> {
    for unsupported in ["no_grid", "empty_voxel", "static_mlp", "apply_rotation", "antialiasing"] {
        if options.switch(unsupported, false)? {
            return Err(options.fault(unsupported, "is on, which is not computed here", HINT_UNSUPPORTED));
        }
    }
    for (option, most) in [("grid_pe", 0), ("defor_depth", 1)] {
        if options.count(option)?.is_some_and(|value| value > most) {
            return Err(options.fault(
                option,
                format!("is above {most}, and such a field computes something else"),
                HINT_UNSUPPORTED,
            ));
        }
    }

    let multires = options.multires()?;
    let levels = (0..).take_while(|&level| tensors.contains_key(&plane_name(level, 0))).count();
    if levels != multires.len() {
        let message = format!("has {} levels, but the parameters have {levels}", multires.len());
        return Err(options.fault("multires", message, HINT_PAIR));
    }
    let coarsest = multires[0] as usize;
    let [xy, xz, xt] = [0, 1, 2].map(|pair| axes(tensors, &plane_name(0, pair), 4));
    let ([_, channels, y, x], [_, _, z, _], [_, _, time_resolution, _]) = (four(xy?), four(xz?), four(xt?));
    let hidden = axes(tensors, &format!("{PREFIX}feature_out.0.weight"), 2)?;
    let harmonics = axes(tensors, &format!("{PREFIX}shs_deform.3.bias"), 1)?;
    Ok(DeformConfig {
        channels,
        spatial_resolution: [x, y, z].map(|samples| samples / coarsest),
        time_resolution,
        multires,
        width: hidden[0],
        no_dx: options.switch("no_dx", false)?,
        no_ds: options.switch("no_ds", false)?,
        no_dr: options.switch("no_dr", false)?,
        no_do: options.switch("no_do", true)?,
        no_dshs: options.switch("no_dshs", true)?,
        sh_coefficients: harmonics[0] / 3,
        time_axis: TimeAxis::Half,
    })
}

/// The shape of a parameter that must have `count` axes, none of them empty.
fn axes<'a>(tensors: &'a BTreeMap<String, Tensor>, name: &str, count: usize) -> Result<&'a [usize], Fault> {
    let fault = |message: String| Fault::new(format!("parameter `{name}`"), message, HINT_PAIR);
    let shape = &tensors.get(name).ok_or_else(|| fault("is missing".to_owned()))?.shape;
    if shape.len() != count || shape.contains(&0) {
        return Err(fault(format!("has the shape {shape:?}, but {count} axes with numbers belong there")));
    }
    Ok(shape)
}

fn four(shape: &[usize]) -> [usize; 4] {
    std::array::from_fn(|axis| shape.get(axis).copied().unwrap_or(0))
}

/// `cfg_args`: the options of a run by name, the text that Python prints for an `argparse.Namespace`.
pub(super) struct Options(Vec<(String, Literal)>);

impl Options {
    pub(super) fn read(path: &Path) -> Result<Self, DataError> {
        let bytes = read_bounded(path, MAX_OPTIONS_BYTES)?;
        let text = std::str::from_utf8(&bytes).map_err(|error| {
            let place = format!("byte {}", error.valid_up_to());
            Fault::new(place, "is no UTF-8 text", "give the file that training wrote").at(path)
        })?;
        namespace(text).map(Self).map_err(|fault| fault.at(path))
    }

    fn get(&self, name: &str) -> Option<&Literal> {
        self.0.iter().find(|(known, _)| known == name).map(|(_, value)| value)
    }

    /// A string, if there is one.
    pub(super) fn text(&self, name: &str) -> Option<&str> {
        match self.get(name)? {
            Literal::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Whether an option is there and 0 or False: 4D LangSplat's `no_dlang` is a number, and 1 where nothing is said.
    pub(super) fn is_zero(&self, name: &str) -> bool {
        matches!(self.get(name), Some(Literal::Bool(false) | Literal::Int(0)))
    }

    /// What shows where nothing is, display colour.
    pub(super) fn background(&self) -> Option<[f32; 3]> {
        match self.get("white_background")? {
            Literal::Bool(white) => Some([f32::from(u8::from(*white)); 3]),
            _ => None,
        }
    }

    fn fault(&self, option: &str, message: impl Into<String>, hint: &'static str) -> Fault {
        Fault::new(format!("cfg_args, option `{option}`"), message, hint)
    }

    fn kind(&self, option: &str, value: &Literal, kind: &str) -> Fault {
        self.fault(option, format!("is {}, but {kind} belongs there", quoted(&value.to_string())), HINT_PAIR)
    }

    /// An option that older runs do not have is at the original's default.
    fn switch(&self, option: &str, default: bool) -> Result<bool, Fault> {
        match self.get(option) {
            None => Ok(default),
            Some(Literal::Bool(value)) => Ok(*value),
            Some(other) => Err(self.kind(option, other, "True or False")),
        }
    }

    fn count(&self, option: &str) -> Result<Option<usize>, Fault> {
        let Some(value) = self.get(option) else { return Ok(None) };
        match value {
            Literal::Int(count) => usize::try_from(*count).ok().map(Some),
            _ => None,
        }
        .ok_or_else(|| self.kind(option, value, "a count"))
    }

    fn multires(&self) -> Result<Vec<u32>, Fault> {
        const NAME: &str = "multires";
        let value = self.get(NAME).ok_or_else(|| self.fault(NAME, "is missing", HINT_PAIR))?;
        let Literal::List(items) = value else {
            return Err(self.kind(NAME, value, "a list"));
        };
        let factors: Option<Vec<u32>> = items.iter().map(multiplier).collect();
        factors
            .filter(|factors| (1..=MOST_LEVELS).contains(&factors.len()))
            .ok_or_else(|| self.kind(NAME, value, "a list of 1 to 16 factors from 1 to 1024"))
    }
}

fn multiplier(value: &Literal) -> Option<u32> {
    match value {
        Literal::Int(factor) => {
            u32::try_from(*factor).ok().filter(|factor| (1..=LARGEST_MULTIPLIER).contains(factor))
        }
        _ => None,
    }
}

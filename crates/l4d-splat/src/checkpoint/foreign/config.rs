//! Sizes and switches of a field: those that shapes show, those that only `cfg_args` knows, and whether they agree.

use std::collections::BTreeMap;

use l4d_formats::fault::quoted;
use l4d_formats::{Fault, Tensor};

use crate::checkpoint::REMEDY_PAIR;
use crate::checkpoint::cfg_args::{CfgArgs, Literal};
use crate::deform::{DeformConfig, PREFIX, TimeAxis, plane_name};

/// Levels of planes, and how much finer one may be than the first: four and 8 in the original.
const MOST_LEVELS: usize = 16;
const LARGEST_MULTIPLIER: u32 = 1024;

const REMEDY_UNSUPPORTED: &str = "train without this option: no configuration of the original uses it";

/// The configuration of the field whose parameters are `tensors`.
///
/// Sizes come from the shapes of the parameters, multipliers and switches from the options; an option that repeats a
/// size must agree with it.
pub(super) fn derive(args: &CfgArgs, tensors: &BTreeMap<String, Tensor>) -> Result<DeformConfig, Fault> {
    let options = Options(args);
    for unsupported in ["no_grid", "empty_voxel", "static_mlp", "apply_rotation"] {
        if options.switch(unsupported, false)? {
            return Err(options.fault(
                unsupported,
                "is on, and this field computes something else",
                REMEDY_UNSUPPORTED,
            ));
        }
    }
    for (option, most) in [("grid_pe", 0), ("defor_depth", 1)] {
        if options.count(option)?.is_some_and(|value| value > most) {
            return Err(options.fault(
                option,
                format!("is above {most}, and such a field computes something else"),
                REMEDY_UNSUPPORTED,
            ));
        }
    }

    let multires = options.multires()?;
    let levels = (0..).take_while(|&level| tensors.contains_key(&plane_name(level, 0))).count();
    if levels != multires.len() {
        let message = format!("has {} levels, but the parameters have {levels}", multires.len());
        return Err(options.fault("multires", message, REMEDY_PAIR));
    }
    let coarsest = multires[0] as usize;
    let [xy, xz, xt] = [0, 1, 2].map(|pair| axes(tensors, &plane_name(0, pair), 4));
    let ([_, channels, y, x], [_, _, z, _], [_, _, time_resolution, _]) = (four(xy?), four(xz?), four(xt?));
    let hidden = axes(tensors, &format!("{}feature_out.0.weight", PREFIX), 2)?;
    let harmonics = axes(tensors, &format!("{}shs_deform.3.bias", PREFIX), 1)?;
    let config = DeformConfig {
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
    };
    options.compare(&config)?;
    Ok(config)
}

fn int(value: usize) -> Literal {
    Literal::Int(i64::try_from(value).unwrap_or(i64::MAX))
}

/// Samples along x, y, z and t.
fn resolution(config: &DeformConfig) -> Literal {
    Literal::List(config.spatial_resolution.into_iter().chain([config.time_resolution]).map(int).collect())
}

fn find<'a>(tensors: &'a BTreeMap<String, Tensor>, name: &str) -> Result<&'a Tensor, Fault> {
    tensors.get(name).ok_or_else(|| Fault::new(format!("parameter `{name}`"), "is missing", REMEDY_PAIR))
}

/// The shape of a parameter that must have `count` axes, none of them empty.
fn axes<'a>(tensors: &'a BTreeMap<String, Tensor>, name: &str, count: usize) -> Result<&'a [usize], Fault> {
    let shape = &find(tensors, name)?.shape;
    if shape.len() != count || shape.contains(&0) {
        return Err(Fault::new(
            format!("parameter `{name}`"),
            format!("has the shape {shape:?}, but {count} axes with numbers belong there"),
            REMEDY_PAIR,
        ));
    }
    Ok(shape)
}

fn four(shape: &[usize]) -> [usize; 4] {
    std::array::from_fn(|axis| shape.get(axis).copied().unwrap_or(0))
}

struct Options<'a>(&'a CfgArgs);

impl Options<'_> {
    fn fault(&self, option: &str, message: impl Into<String>, remedy: &'static str) -> Fault {
        Fault::new(format!("cfg_args, option `{option}`"), message, remedy)
    }

    fn kind(&self, option: &str, value: &Literal, kind: &str) -> Fault {
        self.fault(
            option,
            format!("is {}, but {kind} belongs there", quoted(&value.to_string())),
            REMEDY_PAIR,
        )
    }

    /// An option that older runs do not have is at the original's default.
    fn switch(&self, option: &str, default: bool) -> Result<bool, Fault> {
        match self.0.get(option) {
            None => Ok(default),
            Some(Literal::Bool(value)) => Ok(*value),
            Some(other) => Err(self.kind(option, other, "True or False")),
        }
    }

    fn count(&self, option: &str) -> Result<Option<usize>, Fault> {
        let Some(value) = self.0.get(option) else { return Ok(None) };
        match value {
            Literal::Int(count) => usize::try_from(*count).ok().map(Some),
            _ => None,
        }
        .ok_or_else(|| self.kind(option, value, "a count"))
    }

    fn multires(&self) -> Result<Vec<u32>, Fault> {
        const NAME: &str = "multires";
        let value = self.0.get(NAME).ok_or_else(|| self.fault(NAME, "is missing", REMEDY_PAIR))?;
        let Literal::List(items) = value else {
            return Err(self.kind(NAME, value, "a list"));
        };
        let factors: Option<Vec<u32>> = items.iter().map(multiplier).collect();
        factors
            .filter(|factors| (1..=MOST_LEVELS).contains(&factors.len()))
            .ok_or_else(|| self.kind(NAME, value, "a list of 1 to 16 factors from 1 to 1024"))
    }

    /// Holds what the options say of sizes against what the shapes say.
    fn compare(&self, config: &DeformConfig) -> Result<(), Fault> {
        self.agree("net_width", self.0.get("net_width"), &int(config.width))?;
        let Some(planes) = self.0.get("kplanes_config") else { return Ok(()) };
        if !matches!(planes, Literal::Dict(_)) {
            return Err(self.kind("kplanes_config", planes, "a dict"));
        }
        let channels = planes.get("output_coordinate_dim");
        self.agree("kplanes_config.output_coordinate_dim", channels, &int(config.channels))?;
        self.agree("kplanes_config.resolution", planes.get("resolution"), &resolution(config))
    }

    fn agree(&self, option: &str, said: Option<&Literal>, seen: &Literal) -> Result<(), Fault> {
        match said {
            Some(said) if said != seen => {
                let said = quoted(&said.to_string());
                Err(self.fault(option, format!("is {said}, but the parameters have {seen}"), REMEDY_PAIR))
            }
            _ => Ok(()),
        }
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

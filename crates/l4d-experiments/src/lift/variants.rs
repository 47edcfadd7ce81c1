//! The lifts that are compared.

use l4d_solve::lift::{ClosedSettings, DistilSettings, FieldSettings, LiftSettings, ReadOut};

/// The row against which the others stand.
pub(super) const BASE: &str = "closed form, as users get it";

/// Share of the derivatives of a step that the active set may leave out (docs/panopticquery.md).
const ACTIVE: f64 = 0.05;

/// Steps of the field that are compared.
const ITERATIONS: [u32; 4] = [250, 500, 1000, 2000];
/// The same for a short look.
const QUICK_ITERATIONS: u32 = 20;

/// One lift; a field is read in both ways, and learned once.
#[derive(Debug, Clone)]
pub(super) struct Variant {
    pub(super) series: &'static str,
    pub(super) setting: String,
    pub(super) lift: LiftSettings,
    /// How it is read; none for lifts that know one alone.
    pub(super) read_outs: Vec<ReadOut>,
}

impl Variant {
    /// Series and names of its rows.
    pub(super) fn rows(&self) -> Vec<(String, String)> {
        if self.read_outs.is_empty() {
            return vec![(self.series.to_owned(), self.setting.clone())];
        }
        let read = |name: &str, read_out| format!("{name}, {}", word(read_out));
        let row = |&read_out| (read(self.series, read_out), read(&self.setting, read_out));
        self.read_outs.iter().map(row).collect()
    }
}

fn word(read_out: ReadOut) -> &'static str {
    match read_out {
        ReadOut::Decode2d => "read in 2D",
        ReadOut::Hard3d => "read in 3D",
    }
}

pub(super) fn variants(is_quick: bool) -> Vec<Variant> {
    let robust = ClosedSettings::robust();
    let closed = |series, setting: &str, settings| Variant {
        series,
        setting: setting.to_owned(),
        lift: LiftSettings::Closed(settings),
        read_outs: Vec::new(),
    };
    let sirt = |steps: u32, smoothness: f32| ClosedSettings { steps, smoothness, ..ClosedSettings::sirt() };
    let mut variants = vec![
        closed("closed form", BASE, robust),
        closed("vote", "vote", ClosedSettings::vote()),
        closed("SIRT", "SIRT, 1 step", sirt(1, 0.0)),
    ];
    if !is_quick {
        let vote_and_graph = ClosedSettings { smoothness: robust.smoothness, ..ClosedSettings::vote() };
        variants.extend([
            closed("vote", "vote, graph", vote_and_graph),
            closed("SIRT", "SIRT, 3 steps", sirt(3, 0.0)),
            closed("SIRT and graph", "SIRT, 1 step, graph", sirt(1, robust.smoothness)),
            closed("SIRT and graph", "SIRT, 3 steps, graph", sirt(3, robust.smoothness)),
        ]);
    }
    let lengths = if is_quick { vec![QUICK_ITERATIONS] } else { ITERATIONS.to_vec() };
    for &iterations in &lengths {
        let exact = FieldSettings { iterations, ..FieldSettings::paper() };
        variants.push(field("field", format!("field, {iterations}"), exact));
    }
    for &iterations in lengths.iter().filter(|_| !is_quick) {
        let active = FieldSettings { iterations, left_out: ACTIVE, ..FieldSettings::paper() };
        variants.push(field("field, active set", format!("field, {iterations}, active set"), active));
    }
    let mut distil = DistilSettings::usual();
    if is_quick {
        distil.field.iterations = QUICK_ITERATIONS;
    }
    variants.push(Variant {
        series: "distillation",
        setting: "closed form, learned by a field".to_owned(),
        lift: LiftSettings::Distil(distil),
        read_outs: Vec::new(),
    });
    variants
}

fn field(series: &'static str, setting: String, settings: FieldSettings) -> Variant {
    let lift = LiftSettings::Field(settings);
    Variant { series, setting, lift, read_outs: vec![ReadOut::Decode2d, ReadOut::Hard3d] }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn rows_have_names_of_their_own() {
        for (is_quick, count) in [(true, 6), (false, 24)] {
            let names: Vec<String> =
                variants(is_quick).iter().flat_map(Variant::rows).map(|(_, name)| name).collect();
            let distinct: BTreeSet<&String> = names.iter().collect();
            assert_eq!((names.len(), distinct.len()), (count, count), "{names:?}");
            assert_eq!(names[0], BASE);
        }
    }
}

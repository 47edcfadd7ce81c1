//! `solve --dry-run`: what a vision-language model would be asked about the queries that are not answered yet.
//!
//! Nothing is sent, and no answer is written. Clips are drawn where they are missing: what is asked depends on them.

use anyhow::{Context as _, Result};
use l4d_data::Report;
use l4d_endpoint::Plan;
use l4d_ground::vlm::Vlm;
use l4d_solve::solve::Method;

use super::pick::SceneQueries;
use super::{Run, question_of};
use crate::models::print_estimate;
use crate::out::{ExitStatus, Printer, refusal};

impl Run<'_> {
    pub(super) fn estimate(&self, picked: &[SceneQueries], out: &Printer) -> Result<ExitStatus> {
        let Some(vlm) = self.grounders.vlm() else {
            return Err(refusal(
                format!("grounder {} asks no model server", self.args.method.grounder.as_str()),
                "leave out --dry-run, or ask a model with --grounder model",
            ));
        };
        let plans = picked.iter().map(|wanted| {
            let plan = self.plan(wanted, vlm).with_context(|| wanted.name.to_string())?;
            Ok((wanted.name.to_string(), plan))
        });
        let plans = plans.collect::<Result<Vec<_>>>()?;
        print_estimate("scene", &plans, vlm.endpoint(), self.args.json, Report::default(), out)
    }

    fn plan(&self, wanted: &SceneQueries, vlm: &Vlm) -> Result<Plan> {
        let places = self.places(&wanted.name);
        let scene = self.open(&wanted.name, &places)?;
        let method =
            Method { grounder: vlm, rasterizer: self.opened.rasterizer.as_ref(), settings: &self.settings };
        let mut total = Plan::default();
        for query in &wanted.queries {
            let (question, dir) = (question_of(query), self.answer_dir(&places.work, query));
            let made_from = method.made_from(&scene, &question);
            if self.finished(query, &dir, &made_from).is_some() {
                continue;
            }
            let views = method.unanswered(&scene, &question, &dir);
            let plan = vlm.estimate(views.into_iter().map(|clip| (clip, &question)));
            total += plan.map_err(|error| {
                let hint = error.hint();
                refusal(format!("{}: {error}", query.id), hint)
            })?;
        }
        Ok(total)
    }
}

//! How much the workflow makes of some scenes: jobs, hours and room, before anything is submitted.

use l4d_data::Profile;

use crate::Result;
use crate::sizes::{CORES, Size};

/// Jobs beside those of scenes: blender, answers, baselines, score, leaderboard.
const COMMON_JOBS: usize = 5;
/// Jobs of a scene that only look or list: check, and plan and settle where several jobs share its pictures.
const fn small_jobs(render_blocks: usize) -> usize {
    if render_blocks == 1 { 1 } else { 3 }
}

/// What is to be made, and how it is cut up.
#[derive(Debug)]
pub struct Estimate {
    /// How much is rendered.
    pub profile: Profile,
    /// How many scenes.
    pub scenes: usize,
    /// Jobs that share a scene's pictures.
    pub render_blocks: usize,
    /// Jobs that share a scene's queries.
    pub solve_blocks: usize,
    /// The stages that take time.
    pub stages: Vec<Stage>,
    /// All jobs, those of the other stages included.
    pub jobs: usize,
}

/// A stage that takes time.
#[derive(Debug)]
pub struct Stage {
    /// The rule of the workflow.
    pub rule: &'static str,
    /// How many jobs.
    pub jobs: usize,
    /// What is made.
    pub things: &'static str,
    /// How many of them in the largest job.
    pub most: usize,
    /// How many of them.
    pub all: usize,
    /// Of one of them.
    pub seconds: f64,
    /// That its files take.
    pub megabytes: f64,
    /// That a job asks for.
    pub memory_mb: u32,
    /// Whether the seconds were not measured.
    pub is_guessed: bool,
}

impl Estimate {
    /// Cuts scenes up so that no job works longer than some minutes, as far as frames, queries and the training of a
    /// scene can be divided. `queries` has their number in each scene.
    ///
    /// # Errors
    /// A profile of captures.
    pub fn new(profile: Profile, queries: &[usize], minutes: u32) -> Result<Self> {
        let size = Size::of(profile)?;
        let scenes = queries.len();
        let limit = f64::from(minutes) * 60.0;
        let frame = size.views as f64 * size.picture;
        let render_blocks = blocks(size.frames, limit / frame);
        let most_queries = queries.iter().copied().max().unwrap_or(0);
        let solve_blocks = blocks(most_queries, limit / size.query);
        let stages = vec![
            Stage {
                rule: "render",
                jobs: scenes * render_blocks,
                things: "pictures",
                most: size.frames.div_ceil(render_blocks) * size.views,
                all: scenes * size.frames * size.views,
                seconds: size.picture,
                megabytes: size.picture_mb,
                memory_mb: size.render_mb,
                is_guessed: size.is_guessed("picture"),
            },
            Stage {
                rule: "train",
                jobs: scenes,
                things: "models",
                most: 1,
                all: scenes,
                seconds: size.train,
                megabytes: 0.0,
                memory_mb: size.train_mb,
                is_guessed: size.is_guessed("train"),
            },
            Stage {
                rule: "solve",
                jobs: scenes * solve_blocks,
                things: "answers",
                most: most_queries.div_ceil(solve_blocks),
                all: queries.iter().sum(),
                seconds: size.query,
                megabytes: 0.0,
                memory_mb: size.solve_mb,
                is_guessed: size.is_guessed("query"),
            },
        ];
        let jobs = stages.iter().map(|stage| stage.jobs).sum::<usize>()
            + scenes * small_jobs(render_blocks)
            + COMMON_JOBS;
        Ok(Self { profile, scenes, render_blocks, solve_blocks, stages, jobs })
    }

    /// Rows of a table, its head first.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let head = ["stage", "jobs", "makes", "a job", "minutes", "core-hours", "memory GB", "GB"];
        let all = ["core-hours in all", "GB in all"];
        let mut rows = vec![head.into_iter().chain(all).map(str::to_owned).collect()];
        rows.extend(self.stages.iter().map(Stage::row));
        rows
    }

    /// What the table leaves open.
    pub fn remarks(&self) -> Vec<String> {
        let hours: f64 = self.stages.iter().map(|stage| stage.core_hours(stage.all)).sum();
        let gigabytes: f64 = self.stages.iter().map(|stage| stage.gigabytes(stage.all)).sum();
        let pictures = self.stages.first().map_or(0, |stage| stage.all);
        let small = self.jobs - self.stages.iter().map(|stage| stage.jobs).sum::<usize>();
        let Self { profile, scenes, jobs, .. } = self;
        let mut remarks = vec![
            format!(
                "{scenes} scene{} at {profile}: {jobs} jobs, {pictures} pictures, {} core-hours, {} GB of pictures",
                if *scenes == 1 { "" } else { "s" },
                figures(hours),
                figures(gigabytes)
            ),
            format!(
                "{small} of the jobs only plan, settle, check, score or list: minutes each, which are not counted. \
                 Minutes and hours are those of {CORES} cores a job."
            ),
        ];
        let guessed: Vec<&str> =
            self.stages.iter().filter(|stage| stage.is_guessed).map(|stage| stage.rule).collect();
        if !guessed.is_empty() {
            remarks.push(format!(
                "? not measured at {profile}: {}. What it rests on is in docs/cluster.md (What a job may use).",
                guessed.join(", ")
            ));
        }
        remarks
    }
}

impl Stage {
    fn core_hours(&self, things: usize) -> f64 {
        things as f64 * self.seconds * CORES as f64 / 3600.0
    }

    fn gigabytes(&self, things: usize) -> f64 {
        things as f64 * self.megabytes / 1000.0
    }

    fn row(&self) -> Vec<String> {
        let doubt = if self.is_guessed { "?" } else { "" };
        let room = |things| match self.megabytes > 0.0 {
            true => figures(self.gigabytes(things)),
            false => "-".to_owned(),
        };
        vec![
            self.rule.to_owned(),
            self.jobs.to_string(),
            format!("{} {}", self.all, self.things),
            self.most.to_string(),
            doubt.to_owned() + &figures(self.most as f64 * self.seconds / 60.0),
            doubt.to_owned() + &figures(self.core_hours(self.most)),
            figures(f64::from(self.memory_mb) / 1000.0),
            room(self.most),
            doubt.to_owned() + &figures(self.core_hours(self.all)),
            room(self.all),
        ]
    }
}

/// How many jobs share some things of which one may have so many; at least one, and none without a thing.
fn blocks(things: usize, most: f64) -> usize {
    things.div_ceil(most.max(1.0) as usize).clamp(1, things.max(1))
}

/// A number as far as an estimate is good for.
fn figures(number: f64) -> String {
    match number {
        large if large >= 10.0 => format!("{large:.0}"),
        middle if middle >= 1.0 => format!("{middle:.1}"),
        small => format!("{small:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_job_is_longer_than_asked_where_it_can_be_divided() {
        for profile in Profile::ALL {
            for minutes in [10, 20, 30] {
                let estimate = Estimate::new(profile, &[14, 20, 3], minutes).unwrap();
                for stage in estimate.stages.iter().filter(|stage| stage.most > 1 && stage.rule != "train") {
                    let asked = f64::from(minutes) * 60.0;
                    assert!(stage.most as f64 * stage.seconds <= asked, "{profile} {minutes} {stage:?}");
                    assert!(stage.jobs * stage.most >= stage.all, "{profile} {minutes} {stage:?}");
                }
            }
        }
    }

    #[test]
    fn a_longer_time_than_everything_takes_is_one_job() {
        let estimate = Estimate::new(Profile::Tiny, &[5], 30).unwrap();
        assert_eq!((estimate.render_blocks, estimate.solve_blocks, estimate.jobs), (1, 1, 9));
        assert_eq!(blocks(0, 3.0), 1);
        assert_eq!(blocks(7, 0.2), 7);
        assert_eq!(blocks(97, 3.4), 33);
    }
}

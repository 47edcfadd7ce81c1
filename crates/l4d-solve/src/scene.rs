//! What all answers in one scene share: the model, its clips, and from where masks are wanted.
//!
//! Of a scene, rendered or recorded, only the cameras are read. Refuses to know instances, events, and every picture of
//! the held-out camera.

use std::path::PathBuf;

use l4d_data::capture::{Capture, MASKS, MaskSet};
use l4d_data::digest::sha256_hex;
use l4d_data::layout::{SceneDir, WorkDir};
use l4d_data::workspace::how_scenes_are_made;
use l4d_data::{Camera, DataError, Interval, Name, Profile, Rig, Split, StageError, Timeline, json};
use l4d_ground::ViewClip;
use l4d_splat::checkpoint::own::Sampling;
use l4d_splat::raster::{RasterSettings, Rasterizer};
use l4d_splat::source::{ReaderOptions, Source};
use serde_json::{Value, json};

use crate::clips::{
    self, ClipsFolder, DepthEntry, DepthFormat, DepthKind, Look, Overwrite, Plan, read_views, spread_views,
};
use crate::lift::{ModelStates, RenderedModel};

/// Which clips are looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClipSettings {
    /// Views at most: the paper's V, 8.
    pub views: usize,
    /// Seed of the first of them.
    pub seed: u64,
    /// Which depth goes with colour.
    pub depth: DepthKind,
    /// Frames that are asked about; none for the whole clip.
    pub range: Option<Interval>,
    /// Width and height of the pictures; none for those of the training pictures.
    pub size: Option<[u32; 2]>,
    /// Every so many frames of the clip; none for those of the training pictures.
    pub every: Option<u32>,
}

/// Where a scene stands.
#[derive(Debug, Clone)]
pub struct Places {
    /// Its pictures, of which only the cameras are read.
    pub data: SceneDir,
    /// What can be remade.
    pub work: WorkDir,
    /// The model, if not the one among the work.
    pub model: Option<PathBuf>,
    /// What is said of a model of others.
    pub reader_options: ReaderOptions,
}

impl Places {
    /// Where the model is.
    pub fn splats(&self) -> PathBuf {
        self.model.clone().unwrap_or_else(|| self.work.splats())
    }
}

/// A scene that can be asked about.
#[derive(Debug)]
pub struct SolveScene {
    pub name: Name,
    /// How much is rendered.
    pub profile: Profile,
    /// Its cameras.
    pub rig: Rig,
    pub source: Source,
    /// What the chosen views show.
    pub clips: Vec<ViewClip>,
    /// SHA-256 of what decides each of `clips`.
    pub clip_digests: Vec<String>,
    /// What clips are of: cameras, frames, size.
    pub plan: Plan,
    /// When frames were.
    pub timeline: Timeline,
    /// How pictures and masks are drawn.
    pub raster: RasterSettings,
    /// The model at the times of the clips.
    states: ModelStates,
}

impl SolveScene {
    /// Reads the model, chooses views, and draws what of their clips is not there. `drawn` hears of each
    /// picture that is drawn.
    ///
    /// # Errors
    /// A scene or model that is not there, or a model of another scene or profile; what drawing meets.
    pub fn open(
        name: &Name,
        profile: Profile,
        places: &Places,
        settings: &ClipSettings,
        (rasterizer, adapter): (&dyn Rasterizer, Option<Value>),
        drawn: &(dyn Fn() + Sync),
    ) -> Result<Self, StageError> {
        let rig = read_rig(name, profile, places)?;
        let source = read_model(name, profile, places)?;
        let source = source.on(&places.splats(), rig.timeline(), &rig.clip(profile))?;
        let training = rig.training();
        let chosen = spread_views(&training, settings.views, settings.seed);
        let cameras: Vec<Camera> = chosen.iter().map(|&index| training[index].clone()).collect();
        let timeline = rig.timeline();
        let sampling = source.sampling.unwrap_or(Sampling::WHOLE);
        let every = settings.every.unwrap_or(sampling.every);
        let frames = Sampling { every, ..sampling }.moments(&rig.clip(profile));
        let mut plan = Plan::of_frames(cameras, rig.size(), frames, timeline);
        match settings.size {
            Some(size) => plan.size = size,
            None => (plan.size, plan.camera_size) = sampling.sizes(rig.size()),
        }
        if let Some(range) = settings.range {
            plan.instants.retain(|instant| instant.frame.is_some_and(|frame| range.contains(frame)));
        }
        let background = source.background.unwrap_or_default();
        let look = Look {
            model: (&source).into(),
            rasterizer: rasterizer.name(),
            adapter,
            width: plan.size[0],
            height: plan.size[1],
            background,
            depth: DepthEntry::new(settings.depth, DepthFormat::Exr),
        };
        let root = match settings.depth {
            DepthKind::Sum => places.work.clips_of_summed_depth(),
            DepthKind::Median | DepthKind::Expected => places.work.clips(),
        };
        let folder = ClipsFolder::claim(root, look, &plan, Overwrite::Stale)?;
        clips::complete(&folder, &plan, &source.model, rasterizer, drawn)?;
        let clip_digest = |view| {
            let drawn = folder.view_digest(&plan, view);
            // Rendered frames follow each other at one rate; moments of a capture do not.
            match timeline == Timeline::CANONICAL {
                true => drawn,
                false => sha256_hex(format!("{drawn} {}", timeline.duration_s()).as_bytes()),
            }
        };
        Ok(Self {
            name: name.clone(),
            profile,
            clips: read_views(&folder, &plan, timeline)?,
            clip_digests: (0..plan.cameras.len()).map(clip_digest).collect(),
            raster: RasterSettings { background, near_m: source.near_m, ..RasterSettings::default() },
            states: ModelStates::at(plan.instants.iter().map(|instant| instant.time)),
            plan,
            timeline,
            rig,
            source,
        })
    }

    /// What answers are lifted onto. All of them share the states of the model.
    pub fn rendered<'a>(&'a self, rasterizer: &'a dyn Rasterizer) -> RenderedModel<'a> {
        RenderedModel {
            model: &self.source.model,
            rasterizer,
            raster: &self.raster,
            states: Some(&self.states),
        }
    }

    /// SHA-256 of everything that its answers depend on: model and clips.
    pub fn digest(&self) -> String {
        let decides = json!([self.name, self.profile.as_str(), self.source.inputs, self.clip_digests]);
        sha256_hex(json::canonical(&decides).as_bytes())
    }

    /// From where and when the judge wants masks: the held-out camera at the frames of the clip that it saw. A capture
    /// may hold several out; the judge's is the one that is drawn on.
    ///
    /// # Errors
    /// A scene without a held-out camera.
    pub fn judged(&self, places: &Places) -> Result<Plan, DataError> {
        let path = places.data.rig(self.profile);
        let held_out = self.rig.cameras.iter().filter(|camera| camera.split == Split::Test).count();
        let drawn_on = if held_out > 1 { drawn_on(&places.data)? } else { None };
        let camera = match &drawn_on {
            Some(view) => self.rig.camera(view),
            None => self.rig.held_out(),
        };
        let camera = camera.cloned().ok_or_else(|| {
            let hint = match self.profile.is_rendered() {
                true => "build the scene again",
                false => "import the scene again with --held-out, or name some with --views",
            };
            DataError::invalid(&path, "field `cameras`", "has no camera of split `test`", hint)
        })?;
        let clip = self.rig.clip(self.profile);
        let saw: Vec<u32> = clip.into_iter().filter(|frame| self.rig.saw(&camera.name, *frame)).collect();
        Ok(Plan::of_frames(vec![camera], self.rig.size(), saw, self.timeline))
    }
}

/// The held-out view of a capture on which somebody drew, where there are masks.
fn drawn_on(dir: &SceneDir) -> Result<Option<Name>, DataError> {
    if !dir.root().join(MASKS).exists() {
        return Ok(None);
    }
    let capture = Capture::read(dir.root())?;
    let drawn = MaskSet::read(dir.root())?;
    let is_drawn = |view: &Name| drawn.instances.iter().any(|one| one.masks.contains_key(view));
    Ok(capture.held_out().map(|camera| camera.name.clone()).find(is_drawn))
}

fn read_rig(name: &Name, profile: Profile, places: &Places) -> Result<Rig, DataError> {
    let path = places.data.rig(profile);
    if !path.exists() {
        let hint =
            format!("{}, or choose another --data", how_scenes_are_made(name, profile, places.data.root()));
        return Err(DataError::invalid(places.data.root(), "scene", "there is no scene", hint));
    }
    let rig = Rig::read(&path)?;
    if profile.is_rendered() && rig.size() != [profile.width(), profile.height()] {
        let message = format!("pictures of {}x{} are not of profile {profile}", rig.width, rig.height);
        return Err(DataError::invalid(
            &path,
            "field `width`",
            message,
            "choose another --profile or --data",
        ));
    }
    if rig.training().is_empty() {
        let message = "has no camera of split `train`";
        return Err(DataError::invalid(&path, "field `cameras`", message, "make the scene again"));
    }
    Ok(rig)
}

fn read_model(name: &Name, profile: Profile, places: &Places) -> Result<Source, DataError> {
    let path = places.splats();
    let train = format!("run `l4d train-splats {name} --profile {profile}` first");
    if !path.exists() {
        return Err(DataError::invalid(&path, "model", "there are no splats", train));
    }
    let source = Source::open(&path, places.reader_options)?;
    let other = |what: &str, found: &dyn std::fmt::Display| {
        let message = format!("was trained on {what} {found}");
        DataError::invalid(&path, "model", message, format!("{train}, or give the right --splats"))
    };
    match (&source.scene, source.profile) {
        (Some(scene), _) if scene != name => Err(other("scene", scene)),
        (_, Some(trained)) if trained != profile => Err(other("profile", &trained)),
        _ => Ok(source),
    }
}

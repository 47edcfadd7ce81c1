//! What an annotator may know of a scene: views, frames, and objects under numbers that say nothing.
//!
//! `scene.json` also tells what happens and what things are called; none of that leaves this module.

mod capture;

use std::collections::BTreeMap;
use std::path::Path;

use glam::UVec2;
use l4d_data::digest::sha256;
use l4d_data::layout::SceneDir;
use l4d_data::scene::{Role, Scene};
use l4d_data::timeline::FPS;
use l4d_data::{Camera, DataError, Interval, Name, Profile, Split};
use l4d_frames::overlay::{Mark, object_colour};
use l4d_votes::Round;
use rand::SeedableRng as _;
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;

/// An object under the number that this annotator sees.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Object {
    /// From 1.
    pub number: usize,
    /// Value of the `id` channel.
    pub id: u32,
    /// What goes into the log.
    pub name: Name,
}

/// A scene, as far as an annotator sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneInfo {
    /// Columns and rows of every picture.
    pub size: UVec2,
    /// Factor on linear light.
    pub exposure: f64,
    /// Views that may be looked at; the first is shown first.
    pub views: Vec<Name>,
    /// Frames that can be looked at, ascending.
    pub frames: Vec<u32>,
    /// Which of them is shown first: one on which objects are known.
    pub opening: usize,
    /// Where known.
    pub frames_per_second: Option<f64>,
    /// Whether pictures were taken, and objects drawn by people, instead of both being rendered.
    pub is_capture: bool,
    pub objects: Vec<Object>,
}

/// The scenes of a round.
pub type Scenes = BTreeMap<Name, SceneInfo>;

impl SceneInfo {
    /// From the first frame to the last.
    pub fn whole(&self) -> Interval {
        let ends = self.frames.first().zip(self.frames.last());
        ends.and_then(|(&first, &last)| Interval::new(first, last).ok()).unwrap_or(Interval::WHOLE)
    }

    /// The object under a number.
    pub fn object(&self, number: usize) -> Option<&Object> {
        self.objects.get(number.checked_sub(1)?)
    }

    /// The number of an object.
    pub fn number_of(&self, name: &Name) -> Option<usize> {
        self.objects.iter().find(|object| object.name == *name).map(|object| object.number)
    }

    /// How objects are outlined: the colour goes with the number, not with the object.
    pub(crate) fn marks(&self) -> Vec<Mark> {
        let mark = |object: &Object| Mark {
            id: object.id,
            number: object.number,
            colour: object_colour(object.number - 1),
            faint: false,
        };
        self.objects.iter().map(mark).collect()
    }

    fn new(scene: &Scene, round: &Round, annotator: &Name) -> Self {
        Self {
            size: UVec2::new(scene.width, scene.height),
            exposure: scene.exposure,
            views: chosen_views(&scene.cameras, round.views),
            frames: scene.profile.frames().collect(),
            opening: 0,
            frames_per_second: Some(FPS),
            is_capture: false,
            objects: numbered(objects(scene), &scene.name, round.seed, annotator),
        }
    }
}

/// Reads the scenes of a round and makes sure that every picture that may be asked for is there.
///
/// # Errors
/// A scene cannot be read, or pictures of it are missing.
pub fn load(data: &Path, round: &Round, annotator: &Name) -> Result<Scenes, DataError> {
    let mut scenes = Scenes::new();
    let mut lacking = BTreeMap::new();
    for item in &round.items {
        let name = &item.scene;
        if scenes.contains_key(name) || lacking.contains_key(name) {
            continue;
        }
        if !round.profile.is_rendered() {
            scenes.insert(name.clone(), capture::card(data, name, round, annotator)?);
            continue;
        }
        let dir = SceneDir::new(data, name);
        if !dir.scene().is_file() {
            lacking.insert(name.clone(), "is not rendered".to_owned());
            continue;
        }
        let scene = Scene::read(&dir.scene())?;
        if scene.profile != round.profile {
            lacking.insert(name.clone(), format!("is rendered for profile {}", scene.profile));
            continue;
        }
        let card = SceneInfo::new(&scene, round, annotator);
        match missing_pictures(&dir, &card) {
            0 => drop(scenes.insert(name.clone(), card)),
            count => drop(lacking.insert(name.clone(), format!("lacks {count} pictures"))),
        }
    }
    if lacking.is_empty() { Ok(scenes) } else { Err(not_rendered(data, round.profile, &lacking)) }
}

fn missing_pictures(dir: &SceneDir, card: &SceneInfo) -> usize {
    let pictures = card.views.iter().flat_map(|view| card.frames.iter().map(move |frame| (view, *frame)));
    pictures.filter(|(view, frame)| !dir.frame(view, *frame).is_file()).count()
}

fn not_rendered(data: &Path, profile: Profile, lacking: &BTreeMap<Name, String>) -> DataError {
    let names: Vec<&str> = lacking.keys().map(Name::as_str).collect();
    let message: Vec<String> = lacking.iter().map(|(name, what)| format!("{name} {what}")).collect();
    DataError::invalid(
        data,
        "scenes",
        message.join(", "),
        format!(
            "run `l4d build-scenes --profile {profile} --scenes {}`, or choose another --data",
            names.join(",")
        ),
    )
}

/// The held-out view, whose masks are scored, then those that are farthest from the ones before.
fn chosen_views(cameras: &[Camera], count: usize) -> Vec<Name> {
    let first_frame = 0;
    let place = |camera: &Camera| camera.world_from_camera(first_frame).w_axis.truncate();
    let (mut chosen, mut others): (Vec<_>, Vec<_>) =
        cameras.iter().partition(|camera| camera.split == Split::Test);
    while chosen.len() < count {
        let gap = |camera: &Camera| {
            let distances = chosen.iter().map(|other| place(other).distance_squared(place(camera)));
            distances.min_by(f64::total_cmp).unwrap_or(f64::INFINITY)
        };
        // Of equals the first by name, so that the choice depends on nothing else.
        let farthest =
            (0..others.len()).max_by(|&a, &b| gap(others[a]).total_cmp(&gap(others[b])).then(b.cmp(&a)));
        let Some(farthest) = farthest else { break };
        let camera = others.remove(farthest);
        chosen.push(camera);
    }
    chosen.iter().map(|camera| camera.name.clone()).collect()
}

fn objects(scene: &Scene) -> Vec<(u32, Name)> {
    let objects = scene.instances.iter().filter(|instance| instance.role == Role::Object);
    objects.map(|instance| (instance.id, instance.name.clone())).collect()
}

/// Numbers drawn by lot for each annotator and scene: learnable, but telling nothing about the recipe's order.
fn numbered(mut objects: Vec<(u32, Name)>, scene: &Name, seed: u64, annotator: &Name) -> Vec<Object> {
    objects.sort();
    let seed = sha256(format!("numbers/{seed}/{annotator}/{scene}").as_bytes());
    objects.shuffle(&mut ChaCha8Rng::from_seed(seed));
    let number = |(index, (id, name))| Object { number: index + 1, id, name };
    objects.into_iter().enumerate().map(number).collect()
}

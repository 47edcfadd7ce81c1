//! The grounder that looks at all views of a scene before it answers in any.
//!
//! What the paper's consensus has to reconcile afterwards is put together before the sentence is judged: what each
//! picture shows is lifted to the Gaussians, which make up one scene over time; the sentence has one answer there, drawn
//! into each view. A rival of grounding view by view, and reported apart from it.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use l4d_data::digest::sha256_hex;
use l4d_data::{DataError, StageError};
use l4d_english::Reading;
use l4d_masks::Mask;
use l4d_network::{Found, Seen};
use serde_json::{Value, json};

use super::believe::Scene;
use super::bodies::{joined, steadied};
use super::cluster::{Cluster, Segment, Shown, clusters, labelled, largest};
use super::elements::GaussianProjector;
use super::given::{Given, Part};
use super::look::{Things, look_at_all, mean_of, picture_of, presence, scene_of, weight};
use super::perceive::{Body, Perceived, Track};
use super::surface::Surface;
use super::{Panoptic, unusable};
use crate::clip::ViewClip;
use crate::grounder::{Grounder, Grounding, Outcome, Question};
use crate::unreadable::Unreadable;

/// Pixels from which a view tells where something is.
const LEAST_PX: usize = 6;

/// The panoptic grounder about one scene, whose views it knows together.
pub struct Fused {
    panoptic: Arc<Panoptic>,
    /// By digest of the clip: number of the thing at each pixel of each frame, from 1; 0 for none.
    labels: BTreeMap<String, Vec<Vec<u16>>>,
    things: Things,
    /// None if nothing is seen.
    scene: Option<Scene>,
    given: Option<Given>,
}

/// A frame of a clip, and what the network says of it.
struct Picture<'c> {
    clip: &'c ViewClip,
    frame: u32,
    seen: Seen,
}

impl Fused {
    /// Looks at the views of a scene, and puts together what they show; `given` has what to take from the truth.
    ///
    /// # Errors
    /// Weights that cannot be run, Gaussians that cannot be drawn, truth that cannot be read.
    pub fn new(
        panoptic: Arc<Panoptic>,
        clips: &[ViewClip],
        elements: &dyn GaussianProjector,
        given: Option<Given>,
    ) -> Result<Self, StageError> {
        let known = given.as_ref().filter(|given| given.gives(Part::Things));
        let pictures = match known {
            Some(given) => labelled_pictures(&panoptic, clips, given)?,
            None => pictures(&panoptic, clips)?,
        };
        let shown = pictures.iter().map(|picture| picture.shown(elements)).collect::<Result<Vec<_>, _>>()?;
        let segments: Vec<Segment> =
            pictures.iter().enumerate().flat_map(|(number, picture)| picture.segments(number)).collect();
        let clusters = match known {
            Some(given) => labelled(&shown, &segments, given.instances()),
            None => clusters(&shown, &segments),
        };
        let count = shown.first().map_or(0, |shown| shown.label.len());
        let owners = owners(&clusters, count);
        let mut things_of = vec![Vec::new(); pictures.len()];
        for (thing, cluster) in clusters.iter().enumerate() {
            for &number in &cluster.segments {
                things_of[segments[number].picture].push((segments[number].label, thing as u16 + 1));
            }
        }
        let tracks = tracks(clips, &things_of, &pictures, clusters.len());
        let things = things(clips, &clusters, &segments, &pictures, tracks);
        let mut outlined = pictures.iter().zip(&things_of).map(|(picture, things_of)| {
            let drawn = picture.drawn(elements, &owners, clusters.len())?;
            Ok(picture.outlined(drawn, things_of))
        });
        let mut labels = BTreeMap::new();
        for clip in clips {
            let frames = outlined.by_ref().take(clip.frames.len()).collect::<Result<_, StageError>>()?;
            labels.insert(clip.digest(), frames);
        }
        let mut scene = Scene::of(&things, panoptic.network.description());
        if let Some((given, scene)) = given.as_ref().zip(scene.as_mut()) {
            let instances = instances(given, &clusters, &segments, &pictures)
                .map_err(|error| StageError::of(&error, "build the scene again"))?;
            given.correct(scene, &instances);
        }
        Ok(Self { panoptic, labels, things, scene, given })
    }

    /// What a question means.
    fn read(&self, question: &Question) -> Result<Reading, Unreadable> {
        let given = self.given.as_ref().and_then(|given| given.meaning(question.number.as_ref()));
        let known = given.map(|(predicate, temporal)| Reading::certain(predicate.clone(), *temporal));
        known.map_or_else(|| self.panoptic.read(&question.text), Ok)
    }

    fn answer(&self, clip: &ViewClip, question: &Question) -> Result<Grounding, Outcome> {
        let reading = self.read(question).map_err(Outcome::Unsupported)?;
        let Some(labels) = self.labels.get(&clip.digest()) else {
            return Err(Outcome::Error("this view was not among those that were looked at".to_owned()));
        };
        let judged = self.panoptic.judge(self.scene.as_ref(), &self.things, &reading)?;
        let thing = judged.best.as_ref().and_then(|best| self.things.number(&best.name));
        let mask = |(labels, frame): (&Vec<u16>, u32)| {
            let mut mask = Mask::empty(clip.width, clip.height);
            let wanted = thing.map(|thing| thing as u16 + 1);
            let pixels = labels.iter().enumerate().filter(|(_, label)| Some(**label) == wanted);
            pixels.for_each(|(at, _)| mask.set(at as u32 % clip.width, at as u32 / clip.width, true));
            (frame, mask)
        };
        let masks = labels.iter().zip(clip.frame_numbers()).map(mask).collect();
        Ok(judged.shown(clip, masks, question))
    }
}

impl Grounder for Fused {
    fn identity(&self) -> Value {
        let clips: Vec<&str> = self.labels.keys().map(String::as_str).collect();
        json!({
            "kind": "panoptic-fused",
            "version": 7,
            "weights": self.panoptic.network.description().sha256,
            "views": sha256_hex(clips.concat().as_bytes()),
            "given": self.given.as_ref().map(|given| given.parts()),
        })
    }

    fn uses_truth(&self) -> bool {
        self.given.is_some()
    }

    fn reads(&self, text: &str) -> Result<(), Unreadable> {
        self.panoptic.reads(text)
    }

    fn knows(&self) -> Option<String> {
        self.panoptic.knows()
    }

    fn words(&self) -> Vec<(String, String)> {
        self.panoptic.words()
    }

    fn ground(&self, clip: &ViewClip, question: &Question) -> Grounding {
        self.answer(clip, question).unwrap_or_else(Grounding::without_answer)
    }
}

fn pictures<'c>(panoptic: &Panoptic, clips: &'c [ViewClip]) -> Result<Vec<Picture<'c>>, StageError> {
    let mut pictures = Vec::new();
    for clip in clips {
        let seen = look_at_all(clip, &panoptic.network)
            .map_err(|error| unusable(format!("looking at the views: {error}")))?;
        pictures.extend(clip.frame_numbers().zip(seen).map(|(frame, seen)| Picture { clip, frame, seen }));
    }
    Ok(pictures)
}

/// The same, if the pixels of every instance are known.
fn labelled_pictures<'c>(
    panoptic: &Panoptic,
    clips: &'c [ViewClip],
    given: &Given,
) -> Result<Vec<Picture<'c>>, StageError> {
    let mut pictures = Vec::new();
    for clip in clips {
        for frame in &clip.frames {
            let labels = given
                .labels(clip, frame.frame)
                .map_err(|error| StageError::of(&error, "build the scene again"))?;
            let found = panoptic
                .network
                .describe_things(&picture_of(frame), &labels, given.instances())
                .map_err(|error| unusable(format!("looking at the views: {error}")))?;
            pictures.push(Picture { clip, frame: frame.frame, seen: Seen { labels, found } });
        }
    }
    Ok(pictures)
}

/// For each thing the number of the instance that most of its pixels show; none for those of the background.
fn instances(
    given: &Given,
    clusters: &[Cluster],
    segments: &[Segment],
    pictures: &[Picture<'_>],
) -> Result<Vec<Option<usize>>, DataError> {
    if given.gives(Part::Things) {
        return Ok((0..clusters.len()).map(Some).collect());
    }
    let truth = pictures.iter().map(|picture| given.labels(picture.clip, picture.frame));
    let truth = truth.collect::<Result<Vec<_>, _>>()?;
    let instance = |cluster: &Cluster| {
        let mut pixels = vec![0_u64; given.instances() + 1];
        for &number in &cluster.segments {
            let Segment { picture, label, .. } = segments[number];
            let labels = pictures[picture].seen.labels.iter().zip(&truth[picture]);
            labels.filter(|(own, _)| **own == u32::from(label)).for_each(|(_, id)| pixels[*id as usize] += 1);
        }
        (0..pixels.len()).rev().max_by_key(|&number| pixels[number])?.checked_sub(1)
    };
    Ok(clusters.iter().map(instance).collect())
}

impl Picture<'_> {
    fn shown(&self, elements: &dyn GaussianProjector) -> Result<Shown, StageError> {
        let channels = self.seen.found.len() + 1;
        let mut pixels = vec![0.0; self.seen.labels.len() * channels];
        for (row, &label) in pixels.chunks_exact_mut(channels).zip(&self.seen.labels) {
            row[label as usize] = 1.0;
        }
        let sums = elements.gather(self.clip, self.frame, &pixels, channels)?;
        Ok(Shown::of_sums(&sums, channels))
    }

    /// The thing that each pixel shows, as far as the Gaussians tell.
    fn drawn(
        &self,
        elements: &dyn GaussianProjector,
        owners: &[u16],
        things: usize,
    ) -> Result<Vec<u16>, StageError> {
        let channels = things + 1;
        let mut features = vec![0.0; owners.len() * channels];
        for (row, &owner) in features.chunks_exact_mut(channels).zip(owners) {
            row[usize::from(owner)] = 1.0;
        }
        let blended = elements.splat(self.clip, self.frame, &features, channels)?;
        Ok(blended.chunks_exact(channels).map(|row| largest(row).unwrap_or(0) as u16).collect())
    }

    /// The same with the outlines that the network saw, for those things that it saw here: `things` has the thing of
    /// each label.
    fn outlined(&self, mut drawn: Vec<u16>, things: &[(u16, u16)]) -> Vec<u16> {
        for (pixel, &label) in drawn.iter_mut().zip(&self.seen.labels) {
            let seen = things.iter().find(|(own, _)| u32::from(*own) == label).map(|(_, thing)| *thing);
            let is_outlined = things.iter().any(|(_, thing)| thing == pixel);
            *pixel = seen.unwrap_or(if is_outlined { 0 } else { *pixel });
        }
        drawn
    }

    fn segments(&self, picture: usize) -> Vec<Segment> {
        let mut areas = vec![0; self.seen.found.len() + 1];
        self.seen.labels.iter().for_each(|&label| areas[label as usize] += 1);
        let segment = |(label, &area_px): (usize, &u64)| Segment { picture, label: label as u16, area_px };
        areas.iter().enumerate().skip(1).filter(|(_, area_px)| **area_px > 0).map(segment).collect()
    }

    fn found(&self, label: u16) -> Option<&Found> {
        self.seen.found.get(usize::from(label).checked_sub(1)?)
    }
}

fn things(
    clips: &[ViewClip],
    clusters: &[Cluster],
    segments: &[Segment],
    pictures: &[Picture<'_>],
    tracks: Vec<Track>,
) -> Things {
    let described = |cluster: &Cluster| {
        let segments = cluster.segments.iter().map(|&number| &segments[number]);
        mean_of(
            segments.filter_map(|one| Some((weight(one.area_px), pictures[one.picture].found(one.label)?))),
        )
    };
    let (kinds, values) = clusters.iter().map(described).unzip();
    let presence_of = |cluster: &Cluster| {
        let seen: BTreeSet<usize> = cluster.segments.iter().map(|&number| segments[number].picture).collect();
        presence(seen.len().min(cluster.observer_count), cluster.observer_count)
    };
    Things {
        kinds,
        values,
        presence: clusters.iter().map(presence_of).collect(),
        perceived: Perceived { tracks, ..scene_of(clips) },
    }
}

/// Where each thing is in each frame.
fn tracks(
    clips: &[ViewClip],
    things_of: &[Vec<(u16, u16)>],
    pictures: &[Picture<'_>],
    count: usize,
) -> Vec<Track> {
    let frames = clips.first().map_or(0, |clip| clip.frames.len());
    let mut bodies = vec![vec![Vec::new(); frames]; count];
    let mut rest = pictures.iter().zip(things_of);
    for clip in clips {
        for (at, frame) in clip.frames.iter().enumerate() {
            let Some((picture, things_of)) = rest.next() else { continue };
            let surface = Surface::new(clip, frame);
            let mut pixels = vec![Vec::new(); count];
            for (pixel, &label) in picture.seen.labels.iter().enumerate() {
                if let Some((_, thing)) = things_of.iter().find(|(own, _)| u32::from(*own) == label) {
                    pixels[usize::from(*thing) - 1].push(pixel as u32);
                }
            }
            for (bodies, pixels) in
                bodies.iter_mut().zip(&pixels).filter(|(_, pixels)| pixels.len() >= LEAST_PX)
            {
                if let Some(bodies) = bodies.get_mut(at) {
                    bodies.extend(surface.body(pixels));
                }
            }
        }
    }
    let seconds: Vec<f64> = clips
        .first()
        .map_or(Vec::new(), |clip| clip.frame_numbers().map(|frame| clip.timeline.seconds(frame)).collect());
    let track =
        |of_frames: Vec<Vec<Body>>| Track { bodies: of_frames.iter().map(|seen| joined(seen)).collect() };
    bodies.into_iter().map(|of_frames| steadied(track(of_frames), &seconds)).collect()
}

/// For each Gaussian the number of its thing, from 1; 0 for none.
fn owners(clusters: &[Cluster], count: usize) -> Vec<u16> {
    let mut owners = vec![0; count];
    for (number, cluster) in clusters.iter().enumerate() {
        cluster.elements.iter().for_each(|&element| owners[element as usize] = number as u16 + 1);
    }
    owners
}

//! All views of a scene as one: which of the things of one view is which of another, and what they are together.
//!
//! Things are the same if they are at the same place at the same times, and look alike. Two that one view shows at the
//! same moment are two.

use std::collections::BTreeSet;

use glam::DVec3;

use super::lab::distance;
use super::look::{Looked, PRESENCE_POWER, weight};
use super::perceive::{Glimpse, Perceived, Track};

/// Distance between the same thing in two views, shares of its longest side: they see it from different sides.
const MOST_APART: f64 = 1.0;
/// Colour distance that counts as much as a side of the thing between them.
const COLOUR_COST: f64 = 120.0;
/// Change of the longest side by a factor of e that counts as much.
const SIZE_COST: f64 = 3.0;
/// Points that are kept of a thing at a moment.
const SAMPLES: usize = 60;

/// A track of a view.
pub(super) type Member = (usize, usize);

/// Tracks of views that are one thing; the things with the most pixels first.
pub(super) fn group(views: &[Looked]) -> Vec<Vec<Member>> {
    let all: Vec<Member> = (0..views.len())
        .flat_map(|view| (0..views[view].perceived.tracks.len()).map(move |track| (view, track)))
        .collect();
    let track = |(view, track): Member| &views[view].perceived.tracks[track];
    let mut offers = Vec::new();
    for (first, &a) in all.iter().enumerate() {
        for (second, &b) in all.iter().enumerate().skip(first + 1).filter(|(_, b)| b.0 != a.0) {
            if let Some(cost) = apart(track(a), track(b)).filter(|cost| *cost <= MOST_APART) {
                offers.push((cost, first, second));
            }
        }
    }
    offers.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut group_of: Vec<usize> = (0..all.len()).collect();
    let mut groups: Vec<Vec<usize>> = (0..all.len()).map(|number| vec![number]).collect();
    for (_, first, second) in offers {
        let (into, from) = (group_of[first].min(group_of[second]), group_of[first].max(group_of[second]));
        let clashes = |a: &usize| {
            groups[from].iter().any(|b| all[*a].0 == all[*b].0 && at_once(track(all[*a]), track(all[*b])))
        };
        if into == from || groups[into].iter().any(clashes) {
            continue;
        }
        let moved = std::mem::take(&mut groups[from]);
        moved.iter().for_each(|&number| group_of[number] = into);
        groups[into].extend(moved);
    }
    let pixels = |group: &Vec<Member>| -> u64 {
        group.iter().flat_map(|member| track(*member).seen()).map(|(_, glimpse)| glimpse.area_px).sum()
    };
    let mut groups: Vec<Vec<Member>> = groups
        .into_iter()
        .filter(|group| !group.is_empty())
        .map(|group| group.into_iter().map(|number| all[number]).collect())
        .collect();
    groups.sort_by_key(|group| std::cmp::Reverse(pixels(group)));
    groups
}

/// What the views show together, a track for each group; nothing of no views.
pub(super) fn together(views: &[Looked], groups: &[Vec<Member>]) -> Option<Looked> {
    let first = &views.first()?.perceived;
    let tracks = groups.iter().map(|group| fused_track(views, group, first.frames.len())).collect();
    let share = 1.0 / views.len() as f64;
    let mixed = |of: fn(&Looked) -> &[Vec<f32>]| {
        groups.iter().map(|group| mean_of(views, group, of)).collect::<Vec<Vec<f32>>>()
    };
    Some(Looked {
        presence: groups
            .iter()
            .map(|group| {
                let seen: BTreeSet<usize> = group.iter().map(|member| member.0).collect();
                (seen.len() as f64 * share).powf(PRESENCE_POWER)
            })
            .collect(),
        kinds: mixed(|view| &view.kinds),
        values: mixed(|view| &view.values),
        perceived: Perceived {
            frames: first.frames.clone(),
            timeline: first.timeline,
            tracks,
            scale: first.scale,
            spacing_m: views.iter().map(|view| share * view.perceived.spacing_m).sum(),
            eye: views.iter().map(|view| view.perceived.eye * share).sum(),
        },
    })
}

/// How far apart two tracks are in the frames that show both; none if no frame does.
fn apart(a: &Track, b: &Track) -> Option<f64> {
    let both = a.glimpses.iter().zip(&b.glimpses).filter_map(|(a, b)| Some((a.as_ref()?, b.as_ref()?)));
    let costs: Vec<f64> = both.map(|(a, b)| cost(a, b)).collect();
    (!costs.is_empty()).then(|| costs.iter().sum::<f64>() / costs.len() as f64)
}

fn cost(a: &Glimpse, b: &Glimpse) -> f64 {
    let (one, other) = (a.longest_m().max(1e-6), b.longest_m().max(1e-6));
    let colour = f64::from(distance(a.colour, b.colour)) / COLOUR_COST;
    a.centre.distance(b.centre) / one.max(other) + colour + (one / other).ln().abs() / SIZE_COST
}

fn at_once(a: &Track, b: &Track) -> bool {
    a.glimpses.iter().zip(&b.glimpses).any(|(a, b)| a.is_some() && b.is_some())
}

fn fused_track(views: &[Looked], group: &[Member], frames: usize) -> Track {
    let at = |index: usize| {
        let seen = group
            .iter()
            .filter_map(|&(view, track)| views[view].perceived.tracks[track].glimpses.get(index)?.as_ref());
        fused_glimpse(&seen.collect::<Vec<_>>())
    };
    Track { glimpses: (0..frames).map(at).collect() }
}

/// A thing at a moment, from several sides; pixels are those of the view that shows most of it.
fn fused_glimpse(seen: &[&Glimpse]) -> Option<Glimpse> {
    let best = seen.iter().max_by_key(|glimpse| glimpse.area_px)?;
    let total: f64 = seen.iter().map(|glimpse| glimpse.area_px as f64).sum();
    let weighted = |glimpse: &&Glimpse| glimpse.centre * (glimpse.area_px as f64 / total.max(1.0));
    let points: Vec<_> = seen.iter().flat_map(|glimpse| &glimpse.points).copied().collect();
    let step = points.len().div_ceil(SAMPLES).max(1);
    Some(Glimpse {
        centre: seen.iter().map(weighted).sum(),
        low: seen.iter().map(|glimpse| glimpse.low).fold(best.low, DVec3::min),
        high: seen.iter().map(|glimpse| glimpse.high).fold(best.high, DVec3::max),
        points: points.into_iter().step_by(step).collect(),
        ..(*best).clone()
    })
}

/// Means over the tracks of a group; those that were seen more count more.
fn mean_of(views: &[Looked], group: &[Member], of: fn(&Looked) -> &[Vec<f32>]) -> Vec<f32> {
    let weight = |&(view, track): &Member| weight(&views[view].perceived.tracks[track]);
    let total: f32 = group.iter().map(weight).sum();
    let mut mean = Vec::new();
    for member in group {
        let values = &of(&views[member.0])[member.1];
        mean.resize(values.len(), 0.0);
        let share = weight(member) / total.max(1e-6);
        mean.iter_mut().zip(values).for_each(|(sum, value)| *sum += share * value);
    }
    mean
}

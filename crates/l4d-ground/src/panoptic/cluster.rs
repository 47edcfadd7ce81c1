//! Clusters the segments of all pictures into things, by the Gaussians that they show.
//!
//! Two segments are of one thing if the pictures that see the Gaussians of both show them as one segment: the view
//! consensus of MaskClustering (CVPR 2024), from which the words observer and supporter are. The two cameras may be far
//! apart, since pictures from in between decide. A thing may move, since it keeps its Gaussians over time. Knows
//! neither colours nor words.

/// Pixels of a segment's Gaussians that a picture has to see to be its observer.
const LEAST_PX: f32 = 3.0;
/// Share of those pixels that must be in one segment there.
const MAIN_SHARE: f32 = 0.4;
/// Consensus rate from which two groups are joined.
const LEAST_CONSENSUS_RATE: f32 = 0.4;
/// Added to the observers, so that one picture alone does not make a rate of 1.
const EXTRA_OBSERVERS: f32 = 1.0;
/// Share of what is seen of a Gaussian that must be of a thing.
const OWN_SHARE: f32 = 0.3;

/// What a picture shows of each Gaussian.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Shown {
    /// The segment that it shows in, from 1; 0 for the background.
    pub(super) label: Vec<u16>,
    /// Sum of its blend weights over the picture, pixels.
    pub(super) seen_px: Vec<f32>,
}

impl Shown {
    /// From the sums of blend weights by Gaussian and label, \[Gaussians\]\[labels\].
    pub(super) fn of_sums(sums: &[f32], labels: usize) -> Self {
        let rows = || sums.chunks_exact(labels.max(1));
        Self {
            label: rows().map(|row| largest(row).unwrap_or(0) as u16).collect(),
            seen_px: rows().map(|row| row.iter().sum()).collect(),
        }
    }

    /// Pixels that these Gaussians fill.
    fn seen(&self, elements: &[u32]) -> f32 {
        elements.iter().map(|&element| self.seen_px[element as usize]).sum()
    }

    /// The segment that shows most of these Gaussians; 0 if none does, or if they are not seen.
    fn main_label(&self, elements: &[u32], scratch: &mut Vec<f32>) -> u16 {
        scratch.clear();
        for &element in elements {
            let label = self.label[element as usize] as usize;
            if scratch.len() <= label {
                scratch.resize(label + 1, 0.0);
            }
            scratch[label] += self.seen_px[element as usize];
        }
        let total: f32 = scratch.iter().sum();
        let is_main = |label: &usize| total >= LEAST_PX && scratch[*label] >= MAIN_SHARE * total;
        largest(scratch).filter(is_main).unwrap_or(0) as u16
    }
}

/// A thing that was found in a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Segment {
    /// Index of its picture.
    pub(super) picture: usize,
    /// Its label there, from 1.
    pub(super) label: u16,
    /// Number of its pixels.
    pub(super) area_px: u64,
}

/// A thing.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cluster {
    /// Indices of its segments.
    pub(super) segments: Vec<usize>,
    /// Indices of its Gaussians.
    pub(super) elements: Vec<u32>,
    /// Number of pictures that see enough of its Gaussians to show it.
    pub(super) observer_count: usize,
}

/// Clusters segments into things; those with the most pixels first, those without Gaussians left out.
pub(super) fn clusters(pictures: &[Shown], segments: &[Segment]) -> Vec<Cluster> {
    let mut groups = Agreement::of(pictures, segments).groups();
    let pixels = |group: &Vec<usize>| group.iter().map(|&number| segments[number].area_px).sum::<u64>();
    groups.sort_by_key(|group| std::cmp::Reverse(pixels(group)));
    of_groups(pictures, segments, groups).filter(|cluster| !cluster.elements.is_empty()).collect()
}

/// The clusters of segments whose things are known: label k + 1 means thing k in every picture.
pub(super) fn labelled(pictures: &[Shown], segments: &[Segment], things: usize) -> Vec<Cluster> {
    let mut groups = vec![Vec::new(); things];
    segments.iter().enumerate().for_each(|(number, one)| groups[usize::from(one.label) - 1].push(number));
    of_groups(pictures, segments, groups).collect()
}

fn of_groups(
    pictures: &[Shown],
    segments: &[Segment],
    groups: Vec<Vec<usize>>,
) -> impl Iterator<Item = Cluster> {
    let observer_count =
        |elements: &[u32]| pictures.iter().filter(|shown| shown.seen(elements) >= LEAST_PX).count();
    let owned = owned(pictures, segments, &groups);
    let clusters = groups.into_iter().zip(owned);
    clusters.map(move |(segments, elements)| Cluster {
        observer_count: observer_count(&elements),
        segments,
        elements,
    })
}

/// Index of the largest number, the first of equals.
pub(super) fn largest(values: &[f32]) -> Option<usize> {
    (0..values.len()).rev().max_by(|a, b| values[*a].total_cmp(&values[*b]))
}

/// The Gaussians of each group: those that pictures show more in its segments than in those of any other group.
fn owned(pictures: &[Shown], segments: &[Segment], groups: &[Vec<usize>]) -> Vec<Vec<u32>> {
    let mut group_of: Vec<Vec<usize>> = vec![Vec::new(); pictures.len()];
    for (group, members) in groups.iter().enumerate() {
        for &number in members {
            let Segment { picture, label, .. } = segments[number];
            let of_labels = &mut group_of[picture];
            if of_labels.len() <= label as usize {
                of_labels.resize(label as usize + 1, usize::MAX);
            }
            of_labels[label as usize] = group;
        }
    }
    let mut owned = vec![Vec::new(); groups.len()];
    let mut votes = vec![0.0; groups.len()];
    let count = pictures.first().map_or(0, |shown| shown.label.len());
    for element in 0..count {
        votes.fill(0.0);
        let mut total = 0.0;
        for (shown, group_of) in pictures.iter().zip(&group_of) {
            let seen_px = shown.seen_px[element];
            total += seen_px;
            let group = group_of.get(shown.label[element] as usize).copied();
            if let Some(vote) = group.and_then(|group| votes.get_mut(group)) {
                *vote += seen_px;
            }
        }
        if let Some(group) = largest(&votes).filter(|&group| votes[group] > OWN_SHARE * total) {
            owned[group].push(element as u32);
        }
    }
    owned
}

/// For each pair of groups of segments its observers, the pictures that see the Gaussians of both, and its supporters,
/// the observers that show both as one segment. Symmetric matrices of `count` rows.
struct Agreement {
    count: usize,
    supporters: Vec<f32>,
    observers: Vec<f32>,
}

impl Agreement {
    fn of(pictures: &[Shown], segments: &[Segment]) -> Self {
        let elements_of = |segment: &Segment| -> Vec<u32> {
            let labels = pictures[segment.picture].label.iter().enumerate();
            labels.filter(|(_, label)| **label == segment.label).map(|(element, _)| element as u32).collect()
        };
        let mut scratch = Vec::new();
        let mut shown_as = |segment: &Segment| -> Vec<u16> {
            let elements = elements_of(segment);
            pictures.iter().map(|shown| shown.main_label(&elements, &mut scratch)).collect()
        };
        let rows: Vec<Vec<u16>> = segments.iter().map(&mut shown_as).collect();
        let count = rows.len();
        let (mut supporters, mut observers) = (vec![0.0; count * count], vec![0.0; count * count]);
        for first in 0..count {
            for second in first + 1..count {
                let (mut agree, mut see) = (0u32, 0u32);
                for (a, b) in rows[first].iter().zip(&rows[second]) {
                    let is_seen = *a != 0 && *b != 0;
                    see += u32::from(is_seen);
                    agree += u32::from(is_seen && a == b);
                }
                for at in [first * count + second, second * count + first] {
                    supporters[at] = agree as f32;
                    observers[at] = see as f32;
                }
            }
        }
        Self { count, supporters, observers }
    }

    fn consensus_rate(&self, first: usize, second: usize) -> f32 {
        let at = first * self.count + second;
        self.supporters[at] / (self.observers[at] + EXTRA_OBSERVERS)
    }

    /// Agglomerative clustering: joins the two groups with the highest consensus rate until none reaches
    /// [`LEAST_CONSENSUS_RATE`]. Gives indices of segments.
    fn groups(mut self) -> Vec<Vec<usize>> {
        let count = self.count;
        let mut groups: Vec<Vec<usize>> = (0..count).map(|number| vec![number]).collect();
        let mut best: Vec<Option<(f32, usize)>> = (0..count).map(|row| self.best(row, &groups)).collect();
        loop {
            let likeliest = (0..count).filter_map(|row| best[row].map(|(rate, other)| (rate, row, other)));
            let likeliest = likeliest.reduce(|a, b| if b.0 > a.0 { b } else { a });
            let Some((_, first, second)) = likeliest.filter(|found| found.0 >= LEAST_CONSENSUS_RATE) else {
                break;
            };
            let (into, from) = (first.min(second), first.max(second));
            let moved = std::mem::take(&mut groups[from]);
            groups[into].extend(moved);
            for other in (0..count).filter(|&other| other != into && other != from) {
                for sums in [&mut self.supporters, &mut self.observers] {
                    let sum = sums[into * count + other] + sums[from * count + other];
                    sums[into * count + other] = sum;
                    sums[other * count + into] = sum;
                }
            }
            best[from] = None;
            best[into] = self.best(into, &groups);
            for row in (0..count).filter(|&row| row != into && !groups[row].is_empty()) {
                match best[row] {
                    Some((_, other)) if other == into || other == from => best[row] = self.best(row, &groups),
                    Some((rate, _)) if rate < self.consensus_rate(row, into) => {
                        best[row] = Some((self.consensus_rate(row, into), into));
                    }
                    _ => {}
                }
            }
        }
        groups.retain(|group| !group.is_empty());
        groups
    }

    /// The group with the highest consensus rate with group `row`, the first of equals; none if all rates are 0.
    fn best(&self, row: usize, groups: &[Vec<usize>]) -> Option<(f32, usize)> {
        let others = (0..self.count).filter(|&other| other != row && !groups[other].is_empty());
        let rates =
            others.map(|other| (self.consensus_rate(row, other), other)).filter(|(rate, _)| *rate > 0.0);
        rates.reduce(|a, b| if b.0 > a.0 { b } else { a })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(label: &[u16], seen_px: &[f32]) -> Shown {
        Shown { label: label.to_vec(), seen_px: seen_px.to_vec() }
    }

    fn segment(picture: usize, label: u16) -> Segment {
        Segment { picture, label, area_px: 20 }
    }

    #[test]
    fn front_and_back_are_one_thing_where_a_picture_from_the_side_shows_both() {
        // Gaussians 0 and 1 are the front and the back of a thing, 2 and 3 those of another, 4 is ground.
        let front = shown(&[1, 0, 2, 0, 0], &[9.0, 0.0, 9.0, 0.0, 9.0]);
        let back = shown(&[0, 2, 0, 1, 0], &[0.0, 9.0, 0.0, 9.0, 9.0]);
        let side = shown(&[1, 1, 2, 2, 0], &[5.0, 5.0, 5.0, 5.0, 9.0]);
        let segments: Vec<Segment> =
            (0..3).flat_map(|picture| [segment(picture, 1), segment(picture, 2)]).collect();
        let found = clusters(&[front, back, side], &segments);
        assert_eq!(found.len(), 2, "{found:?}");
        assert_eq!(found[0].elements, [0, 1]);
        assert_eq!(found[1].elements, [2, 3]);
        assert!(found.iter().all(|cluster| cluster.segments.len() == 3 && cluster.observer_count == 3));
    }

    #[test]
    fn two_things_that_one_picture_merges_stay_two_if_the_others_separate_them() {
        let apart = || shown(&[1, 2], &[9.0, 9.0]);
        let pictures = [apart(), shown(&[1, 1], &[9.0, 9.0]), apart(), apart()];
        let segments = [(0, 1), (0, 2), (1, 1), (2, 1), (2, 2), (3, 1), (3, 2)];
        let found = clusters(&pictures, &segments.map(|(picture, label)| segment(picture, label)));
        let elements: Vec<&[u32]> = found.iter().map(|cluster| &*cluster.elements).collect();
        assert!(elements.contains(&&[0][..]) && elements.contains(&&[1][..]), "{found:?}");
    }

    #[test]
    fn no_pictures_or_no_gaussians_give_no_clusters() {
        assert!(clusters(&[], &[]).is_empty());
        assert!(clusters(&[shown(&[], &[])], &[segment(0, 1)]).is_empty());
    }

    #[test]
    fn a_gaussian_shows_in_the_segment_with_most_of_its_pixels() {
        let shown = Shown::of_sums(&[1.0, 3.0, 0.0, 0.0, 0.0, 0.0], 3);
        assert_eq!(shown.label, [1, 0]);
        assert_eq!(shown.seen_px, [4.0, 0.0]);
    }
}

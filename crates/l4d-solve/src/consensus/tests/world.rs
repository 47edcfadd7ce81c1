//! Worlds of spheres and boxes, ray-cast: every depth, mask and hidden point is exact.

use std::collections::BTreeMap;

use glam::{DMat4, DVec2, DVec3};
use half::f16;
use l4d_data::{Camera, Name, Split, Timeline};
use l4d_frames::drawn::{DepthMap, Rgb, RgbImage};
use l4d_ground::{ClipFrame, Grounding, ViewClip};
use l4d_masks::Mask;

/// What a thing looks like around its centre, metres.
#[derive(Clone, Copy)]
pub(crate) enum Shape {
    Sphere(f64),
    /// Half sides.
    Box(DVec3),
}

/// A thing that moves.
#[derive(Clone, Copy)]
pub(crate) struct Thing {
    pub(crate) id: u32,
    pub(crate) shape: Shape,
    pub(crate) centre: fn(u32) -> DVec3,
}

/// Things, cameras and when.
pub(crate) struct World {
    pub(crate) things: Vec<Thing>,
    pub(crate) cameras: Vec<(Camera, [u32; 2])>,
    pub(crate) frames: Vec<u32>,
}

impl Thing {
    /// Distance along a ray to where it enters.
    fn hit(&self, frame: u32, origin: DVec3, ray: DVec3) -> Option<f64> {
        let origin = origin - (self.centre)(frame);
        let distance = match self.shape {
            Shape::Sphere(radius) => {
                let (a, b) = (ray.length_squared(), origin.dot(ray));
                let root = b * b - a * (origin.length_squared() - radius * radius);
                (root >= 0.0).then(|| (-b - root.sqrt()) / a)?
            }
            Shape::Box(half) => {
                let (first, second) = ((-half - origin) / ray, (half - origin) / ray);
                let (enter, leave) = (first.min(second).max_element(), first.max(second).min_element());
                (enter <= leave).then_some(enter)?
            }
        };
        (distance > 0.0).then_some(distance)
    }
}

/// A camera at `eye` that looks at `target`, world +Z up in the picture.
pub(crate) fn looking(
    name: &str,
    eye: DVec3,
    target: DVec3,
    [width, height]: [u32; 2],
    focal_px: f64,
) -> Camera {
    let forward = (target - eye).normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let pose = DMat4::from_cols(
        right.extend(0.0),
        forward.cross(right).extend(0.0),
        forward.extend(0.0),
        eye.extend(1.0),
    );
    Camera {
        name: Name::new(name).expect("names of cameras are names"),
        split: Split::Train,
        fx: focal_px,
        fy: focal_px,
        cx: f64::from(width) / 2.0,
        cy: f64::from(height) / 2.0,
        world_from_camera: vec![pose.transpose().to_cols_array()],
    }
}

/// Cameras on an arc of `degrees` around the origin, 4 m away and 1.5 m up.
pub(crate) fn arc(count: usize, degrees: f64, size: [u32; 2], focal_px: f64) -> Vec<(Camera, [u32; 2])> {
    let camera = |index: usize| {
        let share = if count > 1 { index as f64 / (count - 1) as f64 - 0.5 } else { 0.0 };
        let angle = (degrees * share).to_radians();
        let eye = DVec3::new(4.0 * angle.sin(), -4.0 * angle.cos(), 1.5);
        (looking(&format!("cam{index:02}"), eye, DVec3::ZERO, size, focal_px), size)
    };
    (0..count).map(camera).collect()
}

impl World {
    /// The nearest thing along a ray, and how far it is in lengths of the ray.
    pub(crate) fn hit(&self, frame: u32, origin: DVec3, ray: DVec3) -> Option<(u32, f64)> {
        let hits = self.things.iter().filter_map(|thing| Some((thing.id, thing.hit(frame, origin, ray)?)));
        hits.reduce(|best, next| if next.1 < best.1 { next } else { best })
    }

    /// What a pixel shows: id, and the ray scaled so that its length is the depth.
    fn seen(&self, view: usize, frame: u32, column: u32, row: u32) -> Option<(u32, f64)> {
        let (camera, _) = &self.cameras[view];
        let position = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
        let origin = camera.world_from_camera(frame).w_axis.truncate();
        self.hit(frame, origin, camera.unproject(frame, position, 1.0) - origin)
    }

    pub(crate) fn clip(&self, view: usize) -> ViewClip {
        let (camera, [width, height]) = self.cameras[view].clone();
        let frames = self.frames.iter().map(|&frame| {
            let mut depth = DepthMap::empty(width, height);
            let colour = RgbImage::from_fn(width, height, |column, row| {
                let Some((id, depth_m)) = self.seen(view, frame, column, row) else { return Rgb([90; 3]) };
                let index = (row * width + column) as usize;
                depth.depth_m[index] = depth_m as f32;
                depth.alpha[index] = f16::ONE;
                (depth.near_m[index], depth.far_m[index]) = (f16::from_f64(depth_m), f16::from_f64(depth_m));
                Rgb([40 + (id * 67 % 150) as u8, 40 + (id * 31 % 150) as u8, 40 + (id * 101 % 150) as u8])
            });
            ClipFrame { frame, colour, depth }
        });
        let frames = frames.collect();
        ViewClip { camera, width, height, timeline: Timeline::CANONICAL, frames }
    }

    pub(crate) fn clips(&self) -> Vec<ViewClip> {
        (0..self.cameras.len()).map(|view| self.clip(view)).collect()
    }

    /// The pixels that show a thing.
    pub(crate) fn mask(&self, view: usize, frame: u32, id: u32) -> Mask {
        let [width, height] = self.cameras[view].1;
        Mask::from_fn(width, height, |column, row| {
            self.seen(view, frame, column, row).is_some_and(|(seen, _)| seen == id)
        })
    }

    /// A view that marks a thing whenever it shows it.
    pub(crate) fn marking(&self, clips: &[ViewClip], view: usize, id: u32) -> Grounding {
        let masks: BTreeMap<u32, Mask> =
            self.frames.iter().map(|&frame| (frame, self.mask(view, frame, id))).collect();
        Grounding::of_masks(&clips[view], masks, Vec::new())
    }

    /// The pixels of `to` that show a point of the thing which `from` sees: what re-projection should give.
    pub(crate) fn exact(&self, from: usize, to: usize, frame: u32, id: u32) -> Mask {
        let (camera, [width, height]) = &self.cameras[to];
        let (other, other_size) = &self.cameras[from];
        let eye = other.world_from_camera(frame).w_axis.truncate();
        Mask::from_fn(*width, *height, |column, row| {
            let Some((seen, depth_m)) = self.seen(to, frame, column, row) else { return false };
            let position = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
            let point = camera.unproject(frame, position, depth_m);
            let (there, there_m) = other.project(frame, point);
            let inside = there_m > 0.0
                && there.cmpge(DVec2::ZERO).all()
                && there.x < f64::from(other_size[0])
                && there.y < f64::from(other_size[1]);
            let is_first = || self.hit(frame, eye, point - eye).is_some_and(|(_, share)| share > 1.0 - 1e-9);
            seen == id && inside && is_first()
        })
    }
}

/// Views that all look at the same wall from the same place, 2 m away: what one marks the others would see at the same
/// pixels, so that every count is that of the masks themselves.
pub(crate) struct Wall {
    pub(crate) clips: Vec<ViewClip>,
    pub(crate) groundings: Vec<Grounding>,
}

/// Columns and rows of a [`Wall`].
pub(crate) const WALL: [u32; 2] = [64, 4];

impl Wall {
    /// `masks[view][frame]`: the columns that the view marks in the top row.
    pub(crate) fn new(masks: &[Vec<Vec<std::ops::Range<u32>>>]) -> Self {
        let [width, height] = WALL;
        let pixels = (width * height) as usize;
        let clip = |view: usize, frames: usize| {
            let camera = looking(&format!("cam{view:02}"), DVec3::ZERO, DVec3::Y, WALL, 50.0);
            let depth = DepthMap {
                width,
                height,
                depth_m: vec![2.0; pixels],
                alpha: vec![f16::ONE; pixels],
                near_m: vec![f16::from_f32(2.0); pixels],
                far_m: vec![f16::from_f32(2.0); pixels],
            };
            let colour = RgbImage::from_pixel(width, height, Rgb([120; 3]));
            let frames = (0..frames as u32)
                .map(|frame| ClipFrame { frame, colour: colour.clone(), depth: depth.clone() })
                .collect();
            ViewClip { camera, width, height, timeline: Timeline::CANONICAL, frames }
        };
        let clips: Vec<ViewClip> =
            masks.iter().enumerate().map(|(view, frames)| clip(view, frames.len())).collect();
        let grounding = |(clip, frames): (&ViewClip, &Vec<Vec<std::ops::Range<u32>>>)| {
            let mask = |columns: &Vec<std::ops::Range<u32>>| {
                Mask::from_fn(width, height, |column, row| {
                    row == 0 && columns.iter().any(|range| range.contains(&column))
                })
            };
            let masks = frames.iter().enumerate().map(|(frame, columns)| (frame as u32, mask(columns)));
            Grounding::of_masks(clip, masks.collect(), Vec::new())
        };
        let groundings = clips.iter().zip(masks).map(grounding).collect();
        Self { clips, groundings }
    }

    /// Each view marks the same columns in all of `frames` frames.
    pub(crate) fn still(frames: usize, columns: &[std::ops::Range<u32>]) -> Self {
        let of_view = |range: &std::ops::Range<u32>| vec![vec![range.clone()]; frames];
        Self::new(&columns.iter().map(of_view).collect::<Vec<_>>())
    }
}

//! Balls and blocks that move, seen by casting a ray through each pixel centre: depth, ids and hidden points are exact.

use glam::{DMat3, DVec2, DVec3};
use half::f16;
use l4d_data::scene::Scene;
use l4d_data::timeline::{FPS, FRAME_COUNT, LAST_FRAME};
use l4d_data::tracks::{SCHEMA, Track, TrackedCamera, TrackedInstance, Tracks};
use l4d_data::{Camera, Event, Interval, Profile};
use l4d_frames::{Frame, Surfaces};

use crate::{SIZE, instance, name, scene};

/// What a thing looks like around its centre, metres.
#[derive(Debug, Clone, Copy)]
pub enum Shape {
    Ball(f64),
    /// Full sides; one that is 0 makes a sheet, one that is infinite a floor or a wall.
    Block(DVec3),
}

/// A thing that moves. Time goes from 0 to 1 over the clip.
#[derive(Debug, Clone, Copy)]
pub struct Thing {
    /// 0 is scenery, which is seen and is no instance.
    pub id: u32,
    /// Its category is the part before `_`.
    pub name: &'static str,
    pub shape: Shape,
    /// Its centre at a time, metres.
    pub centre: fn(f64) -> DVec3,
    /// How far it is turned about world +Z at a time, radians.
    pub turn: fn(f64) -> f64,
    /// Linear light from a point, given relative to the centre, metres.
    pub colour: fn(DVec3) -> [f64; 3],
}

/// Things and who looks at them.
#[derive(Debug, Clone)]
pub struct World {
    /// Name of the scene.
    pub name: &'static str,
    /// Of things at the same depth the first is seen.
    pub things: Vec<Thing>,
    /// Linear light where no thing is.
    pub sky: [f64; 3],
    /// For pictures of [`SIZE`].
    pub cameras: Vec<Camera>,
}

fn time(frame: u32) -> f64 {
    f64::from(frame) / f64::from(LAST_FRAME)
}

impl Thing {
    /// A grey ball; the rest by struct update.
    pub const fn ball(id: u32, name: &'static str, radius_m: f64, centre: fn(f64) -> DVec3) -> Self {
        Self { id, name, shape: Shape::Ball(radius_m), centre, turn: |_| 0.0, colour: |_| [0.4; 3] }
    }

    /// A grey block that does not turn; the rest by struct update.
    pub const fn block(id: u32, name: &'static str, sides_m: DVec3, centre: fn(f64) -> DVec3) -> Self {
        Self { shape: Shape::Block(sides_m), ..Self::ball(id, name, 0.0, centre) }
    }

    /// Scenery: the plane z = 0 in two greys, squares of half a metre.
    pub fn floor() -> Self {
        let squares = |at: DVec3| {
            [0.3 + 0.1 * f64::from(((at.x * 2.0).floor() + (at.y * 2.0).floor()) as i64 as u8 & 1); 3]
        };
        let sides_m = DVec3::new(f64::INFINITY, f64::INFINITY, 0.0);
        Self { colour: squares, ..Self::block(0, "floor", sides_m, |_| DVec3::ZERO) }
    }

    fn world_from_box(&self, frame: u32) -> DMat3 {
        DMat3::from_rotation_z((self.turn)(time(frame)))
    }

    /// Lengths of the ray from its origin to the surface.
    fn hit(&self, frame: u32, origin: DVec3, ray: DVec3) -> Option<f64> {
        let box_from_world = self.world_from_box(frame).transpose();
        let origin = box_from_world * (origin - (self.centre)(time(frame)));
        let ray = box_from_world * ray;
        let distance = match self.shape {
            Shape::Ball(radius_m) => {
                let (a, b) = (ray.length_squared(), origin.dot(ray));
                let root = b * b - a * (origin.length_squared() - radius_m * radius_m);
                (root >= 0.0).then(|| (-b - root.sqrt()) / a)?
            }
            Shape::Block(sides_m) => {
                let (one, other) = ((-sides_m / 2.0 - origin) / ray, (sides_m / 2.0 - origin) / ray);
                let (enter, leave) = (one.min(other).max_element(), one.max(other).min_element());
                (enter <= leave).then_some(enter)?
            }
        };
        (distance > 0.0 && distance.is_finite()).then_some(distance)
    }

    fn tracked(&self) -> TrackedInstance {
        let frames = || 0..FRAME_COUNT;
        let extents = match self.shape {
            Shape::Ball(radius_m) => DVec3::splat(2.0 * radius_m),
            Shape::Block(sides_m) => sides_m,
        };
        let described = instance(self.id, self.name);
        TrackedInstance {
            id: described.id,
            name: described.name,
            role: described.role,
            category: described.category,
            attributes: described.attributes,
            front: described.front,
            track: Track {
                centre: frames().map(|frame| (self.centre)(time(frame)).to_array()).collect(),
                axes: frames().map(|frame| self.world_from_box(frame).transpose().to_cols_array()).collect(),
                extents: vec![extents.to_array()],
            },
        }
    }
}

impl World {
    /// The first thing along a ray, and how far it is in lengths of the ray.
    pub fn hit(&self, frame: u32, origin: DVec3, ray: DVec3) -> Option<(&Thing, f64)> {
        let hits = self.things.iter().filter_map(|thing| Some((thing, thing.hit(frame, origin, ray)?)));
        hits.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The thing that a pixel shows, and its planar depth, metres.
    pub fn seen(&self, camera: &Camera, frame: u32, column: u32, row: u32) -> Option<(&Thing, f64)> {
        let centre = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
        let origin = camera.world_from_camera(frame).w_axis.truncate();
        // A point at depth 1, so that lengths of the ray are planar depths.
        self.hit(frame, origin, camera.unproject(frame, centre, 1.0) - origin)
    }

    /// What a camera sees.
    pub fn look(&self, camera: &Camera, frame: u32) -> Frame {
        let mut surfaces = Surfaces::empty(SIZE[0], SIZE[1]);
        let mut rgb = vec![self.sky.map(f16::from_f64); surfaces.id.len()];
        for row in 0..SIZE[1] {
            for column in 0..SIZE[0] {
                let Some((thing, depth_m)) = self.seen(camera, frame, column, row) else { continue };
                let pixel = surfaces.index(column, row);
                let centre = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
                let point = camera.unproject(frame, centre, depth_m) - (thing.centre)(time(frame));
                surfaces.depth_m[pixel] = depth_m as f32;
                surfaces.id[pixel] = thing.id;
                rgb[pixel] = (thing.colour)(point).map(f16::from_f64);
            }
        }
        Frame { surfaces, rgb }
    }

    /// `scene.json`, without digests.
    pub fn scene(&self) -> Scene {
        let instances = self.instances().map(|thing| instance(thing.id, thing.name)).collect();
        Scene { events: self.events(), ..scene(self.name, self.cameras.clone(), instances) }
    }

    /// Where everything is at each canonical frame.
    pub fn tracks(&self) -> Tracks {
        let scene = self.scene();
        let cameras = self.cameras.iter().map(|camera| TrackedCamera {
            name: camera.name.clone(),
            split: camera.split,
            profiles: Profile::ALL.to_vec(),
            focal_over_width: camera.fx / f64::from(SIZE[0]),
            world_from_camera: camera.world_from_camera.clone(),
        });
        Tracks {
            schema: SCHEMA.to_owned(),
            scene: scene.name,
            scale: scene.scale,
            variant: scene.variant,
            seed: scene.seed,
            fps: FPS,
            frame_count: FRAME_COUNT,
            exposure: scene.exposure,
            description: "Made up for a test.".to_owned(),
            instances: self.instances().map(Thing::tracked).collect(),
            events: scene.events,
            pair_reach_m: 0.5,
            pairs: Vec::new(),
            cameras: cameras.collect(),
        }
    }

    fn instances(&self) -> impl Iterator<Item = &Thing> {
        self.things.iter().filter(|thing| thing.id != 0)
    }

    /// The first thing rolls.
    fn events(&self) -> Vec<Event> {
        let roll = |thing: &Thing| Event {
            subject: name(thing.name),
            verb: "roll".to_owned(),
            object: None,
            frames: Interval::WHOLE,
        };
        self.instances().take(1).map(roll).collect()
    }
}

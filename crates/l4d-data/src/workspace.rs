//! The folders of a run: where each of them is unless the user says otherwise. Nothing else assembles such paths.

use std::path::{Path, PathBuf};

use crate::error::DataError;
use crate::layout::{CaptureDir, SceneDir, WorkDir};
use crate::rig::Rig;
use crate::timeline::Profile;

/// The folders that stages of one profile read and write.
#[derive(Debug, Clone)]
pub struct Workspace {
    profile: Profile,
    data: PathBuf,
    work: PathBuf,
}

impl Workspace {
    /// `data/<profile>`, `data/captures` for captures, and `work`, relative to the working folder.
    pub fn new(profile: Profile) -> Self {
        let data = if profile.is_rendered() { format!("data/{profile}") } else { "data/captures".to_owned() };
        Self { profile, data: data.into(), work: "work".into() }
    }

    /// Another folder of scenes, if one is given.
    #[must_use]
    pub fn with_data(mut self, given: Option<&Path>) -> Self {
        if let Some(data) = given {
            self.data = data.to_owned();
        }
        self
    }

    /// Another folder for what can be remade.
    #[must_use]
    pub fn with_work(mut self, work: &Path) -> Self {
        self.work = work.to_owned();
        self
    }

    /// How much is rendered.
    pub fn profile(&self) -> Profile {
        self.profile
    }

    /// The folder of scenes.
    pub fn data(&self) -> &Path {
        &self.data
    }

    /// `<data>/<scene>`.
    pub fn scene(&self, scene: &str) -> SceneDir {
        SceneDir::new(&self.data, scene)
    }

    /// Cameras and times of a scene.
    ///
    /// # Errors
    /// A scene that is not there, with how it gets there; a file that cannot be read.
    pub fn rig(&self, scene: &str) -> Result<Rig, DataError> {
        let dir = self.scene(scene);
        let path = dir.rig(self.profile);
        if !path.exists() {
            let hint = how_scenes_are_made(scene, self.profile, dir.root());
            return Err(DataError::invalid(
                dir.root(),
                "scene",
                format!("is not there at profile {}", self.profile),
                format!("{hint}, or choose another --data"),
            ));
        }
        Rig::read(&path)
    }

    /// `<data>/<scene>`, of a scene that others recorded.
    pub fn capture(&self, scene: &str) -> CaptureDir {
        CaptureDir::new(&self.data, scene)
    }

    /// `<data>/overview.png`.
    pub fn overview(&self) -> PathBuf {
        self.data.join("overview.png")
    }

    /// `<work>/<profile>/<scene>`.
    pub fn work(&self, scene: &str) -> WorkDir {
        WorkDir::new(&self.work, self.profile, scene)
    }

    /// `<work>/<profile>/ablations/<table>`.
    pub fn ablation(&self, table: &str) -> PathBuf {
        self.work.join(self.profile.as_str()).join("ablations").join(table)
    }

    /// `<work>/<profile>/proposals`: queries that models proposed.
    pub fn proposals(&self) -> PathBuf {
        self.work.join(self.profile.as_str()).join("proposals")
    }

    /// What belongs to no profile.
    pub fn shared(&self) -> SharedWork {
        SharedWork::new(&self.work)
    }
}

/// What can be remade and belongs to no profile: `<work>`.
#[derive(Debug, Clone)]
pub struct SharedWork(PathBuf);

impl SharedWork {
    /// `<work>`.
    pub fn new(work: &Path) -> Self {
        Self(work.to_owned())
    }

    /// `bench/<topic>`: speed against error.
    pub fn bench(&self, topic: &str) -> PathBuf {
        self.0.join("bench").join(topic)
    }

    /// `download`: files of releases on their way, and what became of them.
    pub fn downloads(&self) -> PathBuf {
        self.0.join("download")
    }

    /// `frames`: pictures that segmenters are shown.
    pub fn segmenter_frames(&self) -> PathBuf {
        self.0.join("frames")
    }

    /// `blender-env`: Python environments that run Blender.
    pub fn blender_environments(&self) -> PathBuf {
        self.0.join("blender-env")
    }

    /// `workers-env`: Python environments of segmenters.
    pub fn worker_environments(&self) -> PathBuf {
        self.0.join("workers-env")
    }

    /// `logs/<stage>/<name>.log`.
    pub fn log(&self, stage: &str, name: &str) -> PathBuf {
        self.0.join("logs").join(stage).join(format!("{name}.log"))
    }

    /// `jobs`: what workers are asked to do.
    pub fn jobs(&self) -> PathBuf {
        self.0.join("jobs")
    }

    /// `overlays/<round>/<annotator>`: pictures that an annotator keeps.
    pub fn overlays(&self, round: &str, annotator: &str) -> PathBuf {
        self.0.join("overlays").join(round).join(annotator)
    }
}

/// `scores`, or `scores-<set>` of another set than `queries`; followed by `-<what>` where something else than scores is
/// in it. Sets and protocols never share a folder.
pub fn default_scores(set: &str, what: Option<&str>) -> PathBuf {
    named("scores", set, what)
}

/// `leaderboard`, or `leaderboard-<set>` of another set than `queries`.
pub fn default_leaderboard(set: &str) -> PathBuf {
    named("leaderboard", set, None)
}

/// `hosting/<platform>`.
pub fn default_hosting(platform: &str) -> PathBuf {
    Path::new("hosting").join(platform)
}

/// Where a scene comes from that is not at `<data>/<scene>`; another profile at which it is rendered beside it is named.
pub fn how_scenes_are_made(name: &str, profile: Profile, dir: &Path) -> String {
    let of_profile = |other: &Profile| {
        let data = dir.parent().filter(|data| data.ends_with(profile.as_str()))?;
        let scene = SceneDir::new(&data.with_file_name(other.as_str()), name);
        scene.scene().is_file().then(|| format!("rendered at {other}: --profile {other}"))
    };
    let elsewhere = Profile::ALL.iter().find_map(of_profile);
    let make = match profile.is_rendered() {
        true => format!("run `l4d build-scenes --profile {profile} --scenes {name}` first"),
        false => format!("run `l4d import-scene ... --name {name}` first"),
    };
    elsewhere.map_or(make.clone(), |elsewhere| format!("{elsewhere}; or {make}"))
}

fn named(stem: &str, set: &str, what: Option<&str>) -> PathBuf {
    let mut name = stem.to_owned();
    for part in (set != "queries").then_some(set).into_iter().chain(what) {
        name.push('-');
        name.push_str(part);
    }
    name.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_of_another_profile_is_named() {
        let root = tempfile::tempdir().unwrap();
        let ask = || how_scenes_are_made("ball", Profile::Small, &root.path().join("small/ball"));
        let make = "run `l4d build-scenes --profile small --scenes ball` first";
        assert_eq!(ask(), make);
        let tiny = root.path().join("tiny/ball");
        std::fs::create_dir_all(&tiny).unwrap();
        std::fs::write(tiny.join("scene.json"), "").unwrap();
        assert_eq!(ask(), format!("rendered at tiny: --profile tiny; or {make}"));
    }

    #[test]
    fn folders_follow_the_profile_unless_they_are_given() {
        let data = |profile| Workspace::new(profile).data().to_owned();
        assert_eq!(data(Profile::Tiny), Path::new("data/tiny"));
        assert_eq!(data(Profile::Real), Path::new("data/captures"));
        let given = Workspace::new(Profile::Tiny).with_data(Some(Path::new("d"))).with_work(Path::new("w"));
        assert_eq!(given.scene("room").root(), Path::new("d/room"));
        assert_eq!(given.work("room").splats(), Path::new("w/tiny/room/splats"));
        assert_eq!(given.ablation("mvsc"), Path::new("w/tiny/ablations/mvsc"));
        assert_eq!(default_scores("composites", Some("davis")), Path::new("scores-composites-davis"));
    }
}

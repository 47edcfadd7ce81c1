//! From a release to the folders in which the verbs work: what is asked of it, verified, and gone on with after a kill.
//!
//! Files of the release come one at a time into a folder of their own, as `<name>.part` until their digest is the one that
//! `SHA256SUMS` lists. What was unpacked of them is recorded there with the digest of each file that it became. How
//! bytes travel and how a sample becomes a frame is for the caller to say.

mod record;
mod transfer;
mod unpack;

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use l4d_data::camera::Split;
use l4d_data::digest::{sha256_file, sha256_hex};
use l4d_data::layout::{SceneDir, WorkDir};
use l4d_data::name::choose_among;
use l4d_data::store::{FolderLock, write_atomic};
use l4d_data::{DataError, Name, Profile, Progress, Report, StageError, json, sums};
use serde::{Deserialize, Serialize};

use self::record::{Record, Unpacked};
use self::transfer::fetch;
use self::unpack::{Frames, unpack};
use crate::codes;
use crate::contents::{Contents, FILE, SCHEMA, SUMS};
use crate::parts::home;
use crate::shards::stem;

/// Where a release is.
pub trait Base {
    /// Bytes of a file from a byte on: which is the first, and what gives them.
    ///
    /// # Errors
    /// A file that is not there, or cannot be reached.
    fn read(&self, file: &str, from: u64) -> Result<(u64, Box<dyn Read>), Missing>;

    /// What the file is called in messages.
    fn name(&self, file: &str) -> String;
}

/// Why a file does not arrive.
#[derive(Debug)]
pub struct Missing {
    pub message: String,
    /// Whether to ask again may help.
    pub is_passing: bool,
}

/// A release on this machine.
#[derive(Debug)]
pub struct FolderBase(PathBuf);

impl FolderBase {
    /// The folder of a release; of a private test, what the organiser keeps.
    pub fn new(release: &Path) -> Self {
        Self(home(release))
    }
}

impl Base for FolderBase {
    fn read(&self, file: &str, from: u64) -> Result<(u64, Box<dyn Read>), Missing> {
        use std::io::{Seek as _, SeekFrom};
        let opened = File::open(self.0.join(file)).and_then(|mut opened| {
            let first = if from <= opened.metadata()?.len() { from } else { 0 };
            opened.seek(SeekFrom::Start(first))?;
            Ok((first, Box::new(opened) as Box<dyn Read>))
        });
        opened.map_err(|error| Missing { message: error.to_string(), is_passing: false })
    }

    fn name(&self, file: &str) -> String {
        self.0.join(file).display().to_string()
    }
}

/// What can be asked of a release.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Part {
    /// Manifest, queries, tracks and truth.
    Benchmark,
    /// Colours of frames.
    Colour,
    /// Depths of frames.
    Depth,
    /// Instance ids of frames.
    Ids,
    Splats,
    Tables,
}

impl Part {
    /// Names as written on the command line.
    pub const NAMES: [&str; 6] = ["benchmark", "colour", "depth", "ids", "splats", "tables"];
}

/// What is asked, and where it goes.
#[derive(Debug)]
pub struct Wanted<'a> {
    /// Scenes; all if none is named.
    pub scenes: &'a [String],
    /// Splits of the pictures; all if none is named.
    pub splits: &'a [Split],
    /// Parts; all that the release has if none is named.
    pub parts: &'a [Part],
    /// Folder of scenes; `data/<profile>` if none is given.
    pub data: Option<&'a Path>,
    /// Folder of models, and of what is on its way.
    pub work: &'a Path,
    /// Folder of the benchmark.
    pub bench: &'a Path,
    /// Folder of files on their way.
    pub cache: &'a Path,
}

/// Makes the bytes of a frame file from what a sample has under each suffix; its first argument names the sample.
pub type Decode<'a> = &'a (dyn Fn(&Path, &BTreeMap<String, Vec<u8>>) -> Result<Vec<u8>, DataError> + Sync);

/// What a download came to.
#[derive(Debug, Clone, Serialize)]
pub struct Downloaded {
    /// Name and version of the release.
    pub release: String,
    /// Profile of its pictures.
    pub profile: Option<Profile>,
    /// Scenes that were asked for.
    pub scenes: Vec<Name>,
    /// Files of the release that were fetched.
    pub fetched: Vec<String>,
    /// Files of the release that were here already.
    pub kept: Vec<String>,
    /// Where tables are, if there are any.
    pub tables: Option<PathBuf>,
}

/// A release of which it is known what it consists of.
struct Opened<'a> {
    base: &'a dyn Base,
    listed: BTreeMap<String, String>,
    contents: Contents,
    /// Folder of its files on their way, and of the record.
    folder: PathBuf,
}

/// A file of the release, and what becomes of it.
#[derive(Debug)]
struct Task {
    file: String,
    kind: Kind,
    /// Folder below which its files are written.
    target: PathBuf,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Kind {
    /// Kept as it is.
    Keep,
    /// An archive, with what its names begin with.
    Archive(String),
    /// Pictures of a scene.
    Shard(Name),
}

/// Brings what is wanted into the folders of this machine.
///
/// # Errors
/// What is not in the release, cannot be fetched, is not what `SHA256SUMS` lists, or is here already with other content.
pub fn download(
    base: &dyn Base,
    wanted: &Wanted<'_>,
    decode: Decode<'_>,
    progress: &dyn Progress,
) -> Result<Downloaded, StageError> {
    let opened = Opened::open(base, wanted.cache)?;
    let _lock = FolderLock::take(&opened.folder)?;
    let tasks = opened.tasks(wanted)?;
    let with_ids = asks(wanted.parts, Part::Ids);
    let mut record = Record::read(&opened.folder)?;
    let (mut fetched, mut kept) = (Vec::new(), Vec::new());
    progress.start("downloading", tasks.len() as u64);
    for task in &tasks {
        progress.item(&task.file);
        let digest = &opened.listed[&task.file];
        if record.has(&task.file, digest, &task.target, with_ids || !matches!(task.kind, Kind::Shard(_))) {
            // Left over by a run that was killed right after it unpacked the file.
            if task.kind != Kind::Keep {
                fs::remove_file(opened.folder.join(&task.file)).ok();
            }
            kept.push(task.file.clone());
        } else {
            let path = fetch(base, &task.file, digest, &opened.folder)?;
            record.clear(&task.file, &task.target)?;
            let files = match &task.kind {
                Kind::Keep => BTreeMap::from([(task.file.clone(), digest.clone())]),
                Kind::Archive(prefix) => unpack(&path, prefix, &task.target)?,
                Kind::Shard(scene) => {
                    Frames { scene, target: &task.target, with_ids, decode }.unpack(&path)?
                }
            };
            let target = task.target.clone();
            record.add(task.file.clone(), Unpacked { sha256: digest.clone(), target, with_ids, files });
            record.write(&opened.folder)?;
            if task.kind != Kind::Keep {
                fs::remove_file(&path).map_err(|source| DataError::io(&path, "remove", source))?;
            }
            fetched.push(task.file.clone());
        }
        progress.advance(1);
    }
    progress.finish();
    let scenes = opened.scenes(wanted)?;
    if let Some(profile) = opened.profile() {
        for scene in &scenes {
            list_files(&record, &SceneDir::new(&data_of(wanted, profile), scene))?;
        }
    }
    let has_tables = tasks.iter().any(|task| task.kind == Kind::Keep);
    Ok(Downloaded {
        release: format!("{} {}", opened.contents.name, opened.contents.version),
        profile: opened.profile(),
        scenes,
        fetched,
        kept,
        tables: has_tables.then(|| opened.folder.join("tables")),
    })
}

/// Compares what is here with what was asked of the release; nothing is fetched but its lists, and nothing is written
/// besides. Gives how many files were compared.
///
/// # Errors
/// A release whose lists cannot be read, or that lacks what is asked.
pub fn verify(base: &dyn Base, wanted: &Wanted<'_>, report: &mut Report) -> Result<usize, StageError> {
    let opened = Opened::open(base, wanted.cache)?;
    let record = Record::read(&opened.folder)?;
    let mut count = 0;
    for task in opened.tasks(wanted)? {
        let with_ids = asks(wanted.parts, Part::Ids) || !matches!(task.kind, Kind::Shard(_));
        let Some(unpacked) = record.find(&task.file, &opened.listed[&task.file], &task.target, with_ids)
        else {
            let hint = "run the same command without --verify-only";
            report.error(
                codes::MISSING,
                Path::new(&task.file),
                "file",
                "was not downloaded to its end",
                hint,
            );
            continue;
        };
        for (file, digest) in &unpacked.files {
            count += 1;
            let path = task.target.join(file);
            let hint = "remove it, and run the same command without --verify-only";
            match sha256_file(&path) {
                Ok(found) if found == *digest => {}
                Ok(_) => {
                    let message = "are not those that were downloaded";
                    report.error(codes::ALTERED, &path, "bytes", message, hint);
                }
                Err(error) => report.data_error(codes::MISSING, &error),
            }
        }
    }
    Ok(count)
}

impl<'a> Opened<'a> {
    fn open(base: &'a dyn Base, cache: &Path) -> Result<Self, StageError> {
        let list = transfer::read_small(base, SUMS)?;
        let folder = cache.join(&sha256_hex(&list)[..16]);
        let path = folder.join(SUMS);
        write_atomic(&path, &list)?;
        let listed = sums::read(&path)?;
        let named = base.name(FILE);
        let Some(digest) = listed.get(FILE) else {
            let hint = "name the folder or address that holds SHA256SUMS and release.json of a release; of a private \
                        test that is organiser/";
            return Err(StageError::new(format!("{}: lists no {FILE}", base.name(SUMS)), hint));
        };
        let bytes = transfer::read_small(base, FILE)?;
        if sha256_hex(&bytes) != *digest {
            return Err(transfer::altered(&named));
        }
        let contents: Contents = json::parse(Path::new(&named), None, &bytes)?;
        if contents.schema != SCHEMA {
            let message = format!("{named}: is `{}`, but this l4d reads `{SCHEMA}`", contents.schema);
            return Err(StageError::new(message, "use the l4d that made the release"));
        }
        Ok(Self { base, listed, contents, folder })
    }

    fn profile(&self) -> Option<Profile> {
        self.contents.renders.as_ref().map(|renders| renders.profile)
    }

    /// The scenes that are asked for.
    fn scenes(&self, wanted: &Wanted<'_>) -> Result<Vec<Name>, StageError> {
        let known = &self.contents.scenes;
        let mut scenes = Vec::new();
        for asked in wanted.scenes {
            let Some(name) = known.keys().find(|name| name.as_str() == asked) else {
                let names: Vec<&str> = known.keys().map(|name| name.as_str()).collect();
                let message = format!("{}: the release has no scene `{asked}`", self.base.name(FILE));
                return Err(StageError::new(message, choose_among(asked, &names)));
            };
            scenes.push(name.clone());
        }
        if scenes.is_empty() {
            scenes.extend(known.keys().cloned());
        }
        Ok(scenes)
    }

    /// The files of the release that are needed.
    fn tasks(&self, wanted: &Wanted<'_>) -> Result<Vec<Task>, StageError> {
        let scenes = self.scenes(wanted)?;
        let mut tasks = Vec::new();
        let mut add = |file: String, kind: Kind, target: &Path| {
            let is_there = self.listed.contains_key(&file);
            if is_there {
                tasks.push(Task { file, kind, target: target.to_owned() });
            }
            is_there
        };
        let parts = wanted.parts;
        if asks(parts, Part::Benchmark) {
            let inside = || Kind::Archive("benchmark/".to_owned());
            add("archives/benchmark.tar".to_owned(), inside(), wanted.bench);
            for scene in &scenes {
                add(format!("archives/scenes/{scene}.tar"), inside(), wanted.bench);
            }
        }
        if asks(parts, Part::Tables) {
            let tables = self.listed.keys().filter(|file| file.starts_with("tables/"));
            for file in tables {
                add(file.clone(), Kind::Keep, &self.folder);
            }
        }
        let frames = [Part::Colour, Part::Depth].map(|part| asks(parts, part));
        if frames != [true, true] && (frames != [false, false] || asks(parts, Part::Ids)) {
            let hint = "ask for colour,depth or colour,depth,ids: a frame has colour and depth, and `l4d.torch.Scenes` \
                        reads single members of the shards themselves";
            return Err(StageError::new("--parts: frames cannot be made of these parts", hint));
        }
        let Some(profile) = self.profile() else {
            return match parts.iter().any(|part| !matches!(part, Part::Benchmark | Part::Tables)) {
                true => Err(StageError::new(
                    format!("{}: the release holds no pictures and no models", self.base.name(FILE)),
                    "ask for benchmark,tables, or render the scenes with `l4d build-scenes`",
                )),
                false => Ok(tasks),
            };
        };
        let data = data_of(wanted, profile);
        for scene in &scenes {
            if frames == [true, true] {
                let prefix = format!("data/{profile}/{scene}/");
                let dir = SceneDir::new(&data, scene);
                add(format!("archives/renders/{profile}/{scene}.tar"), Kind::Archive(prefix), dir.root());
                for split in [Split::Train, Split::Test] {
                    let is_wanted = wanted.splits.is_empty() || wanted.splits.contains(&split);
                    let stem = stem(profile, scene, split);
                    let shard = |number: u32| format!("{stem}{number:03}.tar");
                    let mut number = 0;
                    while is_wanted && add(shard(number), Kind::Shard(scene.clone()), dir.root()) {
                        number += 1;
                    }
                }
            }
            if asks(parts, Part::Splats) {
                let dir = WorkDir::new(wanted.work, profile, scene).splats();
                let prefix = format!("work/{profile}/{scene}/splats/");
                add(format!("archives/splats/{profile}/{scene}.tar"), Kind::Archive(prefix), &dir);
            }
        }
        Ok(tasks)
    }
}

fn asks(parts: &[Part], part: Part) -> bool {
    parts.is_empty() || parts.contains(&part)
}

fn data_of(wanted: &Wanted<'_>, profile: Profile) -> PathBuf {
    l4d_data::Workspace::new(profile).with_data(wanted.data).data().to_owned()
}

/// Writes the `SHA256SUMS` of a scene as far as it is here.
fn list_files(record: &Record, dir: &SceneDir) -> Result<(), DataError> {
    // Cards of the views are in no such list: `build-scenes` does the same.
    let is_listed = |file: &String| !file.ends_with("/view.json");
    let files = record.below(dir.root());
    let listed: BTreeMap<String, String> = files.filter(|(file, _)| is_listed(file)).collect();
    if listed.is_empty() {
        return Ok(());
    }
    write_atomic(&dir.checksums(), sums::to_text(&listed).as_bytes())
}

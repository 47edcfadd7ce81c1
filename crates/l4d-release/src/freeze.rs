//! From a benchmark to a release folder.
//!
//! Everything is written beside the final folder and moved there at the end: a folder without a leading dot is whole.
//! A run that was killed is continued by the next: archives that exist are kept if `release.json` says that they
//! were made of the same files.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

use l4d_data::digest::sha256_file;
use l4d_data::store::{FolderLock, make_folder, remove_folder, write_atomic};
use l4d_data::{Benchmark, DataError, Profile, Report, json, sums};
use rayon::prelude::*;

use crate::contents::{Contents, FILE, Publication, SUMS};
use crate::documents::Documents;
use crate::gather::{Gathered, Source, gather, size_of};
use crate::inspect::digest_all;
use crate::participants::{Draw, Handout};
use crate::parts::{ORGANISER, PARTICIPANTS, home, parts};
use crate::renders::{self, Renders};
use crate::shards::{self, Encode, Shard};
use crate::splats::{self, Splats};
use crate::version::{self, Change, changes};
use crate::votes::{self, Votes};
use crate::{archive, codes, columnar, croissant, tables, words};

/// What is to be released, and where.
#[derive(Debug)]
pub struct ReleaseOptions<'a> {
    pub bench: &'a Benchmark,
    /// What people's votes say of it.
    pub votes: &'a Votes,
    /// Folder and profile of renders that go into it.
    pub renders: Option<(&'a Path, Profile)>,
    /// Folder of trained models of that profile: those that exist go into it.
    pub work: &'a Path,
    /// An earlier release that the version is compared with.
    pub since: Option<&'a Path>,
    /// Folder of all releases.
    pub out: &'a Path,
    /// What cannot be read from the data.
    pub publication: &'a Publication,
}

/// A release that can be made.
#[derive(Debug)]
pub struct Plan {
    /// What it will consist of.
    pub contents: Contents,
    /// What changed since the earlier release, the gravest first.
    pub changes: Vec<Change>,
    pub folder: PathBuf,
    /// Whether the folder exists already, made of the same files.
    pub is_there: bool,
    gathered: Gathered,
    archives: Vec<Archive>,
    shards: Vec<Shard>,
    handout: Option<Handout>,
}

/// An archive of a release.
#[derive(Debug)]
struct Archive {
    /// Path in the release.
    path: String,
    files: Vec<Source>,
}

/// A finished release.
#[derive(Debug)]
pub struct Released {
    /// File -> its size.
    pub files: BTreeMap<String, u64>,
}

/// Reads a benchmark that is to be published, and compares its statuses with the votes.
///
/// # Errors
/// If its folder cannot be listed.
pub fn examine(bench: &Benchmark, votes: &Votes, report: &mut Report) -> Result<Gathered, DataError> {
    let gathered = gather(bench, report)?;
    votes::check(bench, &gathered, votes, report);
    Ok(gathered)
}

/// Reads everything that goes into a release. Whatever forbids it becomes a finding, all at once; nothing is written.
///
/// # Errors
/// If the benchmark or the earlier release cannot be read.
pub fn plan(order: &ReleaseOptions<'_>, report: &mut Report) -> Result<Plan, DataError> {
    let gathered = examine(order.bench, order.votes, report)?;
    let handout = Handout::of(order.bench, &gathered, order.renders, report)?;
    let renders = order.renders.map(|(data, profile)| {
        let rendered = gathered.scenes.iter().filter(|scene| scene.tracks.is_some()).map(|scene| &scene.name);
        let splats = splats::list(order.work, profile, rendered.clone(), report);
        (renders::list(data, profile, order.bench, rendered, report), splats)
    });
    let there = renders.as_ref().map(|(renders, splats)| (renders, splats));
    let contents = Contents::of(&gathered, order.votes, there, order.publication);
    let before = order.since.map(|since| Contents::read(&home(since))).transpose()?;
    let changes = before.as_ref().map(|before| changes(before, &contents)).unwrap_or_default();
    version::check(&order.bench.dir.manifest(), &contents, before.as_ref(), &changes, report);
    let folder = order.out.join(contents.folder());
    let is_there = folder.exists() && is_same(&folder, &contents, report);
    let rendered = || renders.iter().flat_map(|(renders, _)| renders.scenes.values());
    let shards = rendered()
        .flat_map(|one| {
            shards::shards(&one.scene, shards::MOST_BYTES, |camera, frame| one.picture(camera, frame))
        })
        .collect();
    let archives = archives(&gathered, order.votes, renders.as_ref());
    Ok(Plan { contents, changes, folder, is_there, gathered, archives, shards, handout })
}

/// Whether the release exists already; one with other contents is a finding: what was published stays.
fn is_same(folder: &Path, contents: &Contents, report: &mut Report) -> bool {
    let hint = "raise the version in panoptic-l4d.toml, or choose another --out";
    match Contents::read(&home(folder)) {
        Ok(there) if there == *contents => return true,
        Ok(there) => {
            let found = changes(&there, contents);
            let what =
                found.first().map_or("day, page, creators or manifest differ", |change| change.what.as_str());
            let message = format!("{} was released before, with other contents: {what}", contents.version);
            report.error(codes::FROZEN, folder, "folder", message, hint);
        }
        Err(error) => {
            let message = format!("exists, and is no whole release: {error}");
            report.error(codes::FROZEN, folder, "folder", message, "move it away, or choose another --out");
        }
    }
    false
}

fn archives(gathered: &Gathered, votes: &Votes, renders: Option<&(Renders, Splats)>) -> Vec<Archive> {
    let mut archives =
        vec![Archive { path: "archives/benchmark.tar".to_owned(), files: gathered.files.clone() }];
    if !votes.files.is_empty() {
        archives.push(Archive { path: "archives/annotation.tar".to_owned(), files: votes.files.clone() });
    }
    archives.extend(gathered.scenes.iter().map(|scene| Archive {
        path: format!("archives/scenes/{}.tar", scene.name),
        files: scene.files.clone(),
    }));
    if let Some((Renders { profile, scenes }, splats)) = renders {
        archives.extend(scenes.iter().map(|(scene, rendered)| Archive {
            path: format!("archives/renders/{profile}/{scene}.tar"),
            files: rendered.others(),
        }));
        archives.extend(splats.iter().map(|(scene, files)| Archive {
            path: format!("archives/splats/{profile}/{scene}.tar"),
            files: files.clone(),
        }));
    }
    archives
}

impl Plan {
    /// Bytes that will be read and digested: the length of a progress bar.
    pub fn work_bytes(&self) -> u64 {
        let archives = self.archives.iter().flat_map(|archive| &archive.files).map(|file| file.bytes);
        2 * archives.chain(self.shards.iter().map(Shard::source_bytes)).sum::<u64>()
    }

    /// The folder of what participants get, if not everything is published.
    pub fn participants(&self) -> Option<PathBuf> {
        self.handout.as_ref().map(|_| self.folder.join(PARTICIPANTS))
    }

    /// The licence of the benchmark.
    fn licence(&self) -> Result<Option<Vec<u8>>, DataError> {
        let licence = self.gathered.files.iter().find(|file| file.name == "benchmark/LICENSE");
        let read = |path: &PathBuf| fs::read(path).map_err(|source| DataError::io(path, "read", source));
        licence.map(|licence| read(&licence.path)).transpose()
    }

    /// Where the release is put together.
    fn staging(&self) -> PathBuf {
        self.folder.with_file_name(format!(".{}.partial", self.contents.folder()))
    }
}

/// How pictures are drawn, which is for the caller to say.
pub struct Pictures<'a> {
    /// What participants of a private test see of a scene.
    pub draw: Draw<'a>,
    /// The sample that a frame becomes.
    pub encode: Encode<'a>,
}

/// Makes the release; `progress` gets bytes.
///
/// # Errors
/// If another run makes a release there, or a file cannot be read or written, or changed since the plan.
pub fn freeze(
    plan: &Plan,
    pictures: &Pictures<'_>,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Released, DataError> {
    if plan.is_there {
        return Released::read(&plan.folder);
    }
    let staging = plan.staging();
    let _lock = FolderLock::take(staging.parent().unwrap_or(Path::new(".")))?;
    let home = if plan.handout.is_some() { staging.join(ORGANISER) } else { staging.clone() };
    enter(&staging, &home, &plan.contents)?;
    let documents = write_all(plan, &home, pictures.encode, progress)?;
    if let Some(handout) = &plan.handout {
        let folder = staging.join(PARTICIPANTS);
        handout.write(
            &folder,
            (&plan.gathered, &documents, plan.licence()?.as_deref()),
            pictures.draw,
            progress,
        )?;
    }
    fs::rename(&staging, &plan.folder)
        .map_err(|source| DataError::io(&plan.folder, "move the release to", source))?;
    if let Some(Ok(parent)) = plan.folder.parent().map(File::open) {
        // A filesystem that cannot sync folders is no error.
        parent.sync_all().ok();
    }
    Released::read(&plan.folder)
}

/// Writes archives, tables, documents and sums into a folder.
fn write_all(
    plan: &Plan,
    home: &Path,
    encode: Encode<'_>,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Documents, DataError> {
    for shard in &plan.shards {
        let path = home.join(&shard.path);
        match path.exists() {
            true => progress(shard.source_bytes()),
            false => shard.write(&path, encode, progress)?,
        }
    }
    plan.archives.par_iter().try_for_each(|archive| {
        let path = home.join(&archive.path);
        match path.exists() {
            true => {
                progress(archive.files.iter().map(|file| file.bytes).sum());
                Ok(())
            }
            false => archive::write(&path, &archive.files, progress),
        }
    })?;
    let tables = tables::tables(&plan.gathered);
    let words = words::of(&plan.contents, &plan.gathered)?;
    for table in &tables {
        write_atomic(&home.join(table.path()), &table.bytes())?;
        write_atomic(&home.join(table.parquet_path()), &columnar::bytes(table)?)?;
    }
    let sizes = plan.archives.iter().map(|archive| {
        let path = home.join(&archive.path);
        Ok((archive.path.as_str(), size_of(&path)?, archive.files.len()))
    });
    let shards = plan
        .shards
        .iter()
        .map(|shard| Ok((shard.path.as_str(), size_of(&home.join(&shard.path))?, shard.len())));
    let sizes = sizes.chain(shards).collect::<Result<_, DataError>>()?;
    let documents = Documents::new(&plan.contents, &plan.gathered, &words, &tables, sizes);
    for (name, text) in documents.render()? {
        write_atomic(&home.join(name), text.as_bytes())?;
    }
    if let Some(licence) = plan.licence()? {
        write_atomic(&home.join("LICENSE"), &licence)?;
    }
    let mut files = digest_all(home, progress)?;
    // Neither lists itself; both may be there from a run that was killed at the very end.
    files.remove(croissant::FILE);
    files.remove(SUMS);
    let path = home.join(croissant::FILE);
    json::write(&path, &croissant::document(&plan.contents, &plan.gathered, &words, &tables, &files))?;
    files.insert(croissant::FILE.to_owned(), (sha256_file(&path)?, size_of(&path)?));
    let listed: BTreeMap<String, String> =
        files.into_iter().map(|(file, (digest, _))| (file, digest)).collect();
    write_atomic(&home.join(SUMS), sums::to_text(&listed).as_bytes())?;
    Ok(documents)
}

impl Released {
    /// The files that a release lists.
    fn read(release: &Path) -> Result<Self, DataError> {
        let mut files = BTreeMap::new();
        for part in parts(release) {
            for file in sums::read(&release.join(part).join(SUMS))?.into_keys() {
                let file = Path::new(part).join(file);
                let bytes = size_of(&release.join(&file))?;
                files.insert(file.to_string_lossy().into_owned(), bytes);
            }
        }
        Ok(Self { files })
    }
}

/// Opens the folder in which the release is put together: as a killed run left it if that was after the same, else
/// empty.
fn enter(staging: &Path, home: &Path, contents: &Contents) -> Result<(), DataError> {
    let is_same = json::read::<Contents>(&home.join(FILE)).is_ok_and(|there| there == *contents);
    if !is_same {
        remove_folder(staging)?;
    }
    make_folder(home)?;
    json::write(&home.join(FILE), contents)
}

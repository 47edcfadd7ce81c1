//! The folder of an export: whose it is, and whether it is whole.
//!
//! A folder without a manifest of ours is never written into unless it is empty. The manifest is written first, marked
//! as unfinished, and once more at the end, so that an export that was killed can be run again in place.

use std::path::PathBuf;

use l4d_data::store::{list_folder, make_folder};
use l4d_data::{DataError, json};

use super::Order;
use super::manifest::{Exported, Manifest};
use super::views::SceneViews;

/// Name of the manifest.
pub const MANIFEST: &str = "l4d-export.json";

pub(super) struct Folder {
    manifest: PathBuf,
}

impl Folder {
    /// Takes possession of the folder of an order.
    pub(super) fn claim(order: &Order<'_>, views: &SceneViews) -> Result<Self, DataError> {
        make_folder(order.out)?;
        let path = order.out.join(MANIFEST);
        let refuse = |message: String| {
            let remedy = "choose an empty folder, or remove this one";
            Err(DataError::invalid(order.out, "folder", message, remedy))
        };
        if path.is_file() {
            let earlier: Manifest = json::read(&path)?;
            let (scene, format) = (views.name().as_str(), order.format.as_str());
            if (earlier.scene.as_str(), earlier.format.as_str()) != (scene, format) {
                return refuse(format!("holds {} as {}", earlier.scene, earlier.format));
            }
            if earlier.differs_from(&Manifest::new(order, views)?) {
                return refuse("holds an export of other frames, other pictures or another split".to_owned());
            }
        } else if let Some(entry) = list_folder(order.out)?.first() {
            return refuse(format!("is not empty: `{}` is there", l4d_data::error::inert(entry)));
        }
        json::write(&path, &Manifest::new(order, views)?)?;
        Ok(Self { manifest: path })
    }

    /// Says that the export is whole.
    pub(super) fn settle(self, mut manifest: Manifest) -> Result<Exported, DataError> {
        manifest.complete = true;
        json::write(&self.manifest, &manifest)?;
        Ok(Exported { manifest, path: self.manifest })
    }
}

//! Stable codes of what the judge finds.

/// The folder holds no results.
pub const NO_RESULTS: &str = "L4D301";
/// `method.json` is missing, unreadable or malformed.
pub const BAD_CARD: &str = "L4D302";
/// `method.json` says that the masks were made for something else.
pub const CARD_MISMATCH: &str = "L4D303";
/// A folder of masks for a scene that the benchmark does not have.
pub const UNKNOWN_SCENE: &str = "L4D304";
/// Masks for a query that the scene does not have.
pub const UNKNOWN_QUERY: &str = "L4D305";
/// A file or a frame that has no meaning where it is.
pub const UNKNOWN_ENTRY: &str = "L4D306";
/// The masks of a query are there both as JSON and as PNG, or a frame is there twice.
pub const DUPLICATE: &str = "L4D307";
/// Frames without an answer.
pub const MISSING: &str = "L4D308";
/// Masks of another size.
pub const WRONG_SIZE: &str = "L4D309";
/// Run lengths that are no mask.
pub const BAD_RLE: &str = "L4D310";
/// A PNG that is no mask.
pub const BAD_PNG: &str = "L4D311";
/// A file or folder of masks that cannot be read.
pub const UNREADABLE: &str = "L4D312";
/// A link, which could lead out of the folder.
pub const LINK: &str = "L4D313";
/// A file larger than any sound one.
pub const TOO_LARGE: &str = "L4D314";
/// A folder with more entries, or a file with more frames, than any sound one.
pub const TOO_MANY: &str = "L4D315";
/// More bytes of masks than are taken in.
pub const TOO_MUCH: &str = "L4D316";
/// A query whose referent is visible in no frame.
pub const NEVER_PRESENT: &str = "L4D401";
/// A scene of the benchmark that this profile has no truth or queries for.
pub const SCENE_LEFT_OUT: &str = "L4D402";

//! Codes of findings about foreign results; `docs/findings.md` describes them.

/// Nothing is where the template looks.
pub(super) const NOTHING_FOUND: &str = "L4D540";
/// A file that cannot be read: damaged, hostile, of another kind.
pub(super) const UNREADABLE: &str = "L4D541";
/// A link or special file.
pub(super) const LINK: &str = "L4D542";
/// A field of the template has several values, and nothing says which is meant.
pub(super) const AMBIGUOUS_FIELD: &str = "L4D543";
/// A scene, prompt or number that the benchmark does not have.
pub(super) const UNKNOWN_PROMPT: &str = "L4D544";
/// Two files, or two prompts, for one answer.
pub(super) const COLLISION: &str = "L4D545";
/// A number that is no frame of the clip, or another count of files than of frames.
pub(super) const FRAME_RULE: &str = "L4D546";
/// Another size than the profile, or than the files beside it.
pub(super) const WRONG_SIZE: &str = "L4D547";
/// Queries or frames without an answer.
pub(super) const MISSING: &str = "L4D548";
/// A picture that may be a mask in several ways.
pub(super) const AMBIGUOUS_MASK: &str = "L4D549";
/// Colours where latents belong.
pub(super) const RGB_AS_LATENT: &str = "L4D550";
/// Levels that are the same, byte by byte.
pub(super) const IDENTICAL_LEVELS: &str = "L4D551";
/// One value everywhere.
pub(super) const CONSTANT: &str = "L4D552";
/// Numbers that are not finite.
pub(super) const NOT_FINITE: &str = "L4D553";
/// Latents, decoder and text embeddings have widths that do not fit.
pub(super) const WIDTHS: &str = "L4D554";
/// Text embeddings that are missing, malformed or lack a sentence.
pub(super) const EMBEDDINGS: &str = "L4D555";
/// Masks that cover nearly everything.
pub(super) const COVERS_ALL: &str = "L4D556";
/// Masks that fit the frame before or after better.
pub(super) const FRAME_SHIFT: &str = "L4D557";
/// Masks that hardly touch the truth.
pub(super) const HARDLY_TOUCHES: &str = "L4D558";
/// A claimed number that cannot be read.
pub(super) const CLAIM: &str = "L4D559";
/// Renders of training cameras.
pub(super) const TRAINED_ON: &str = "L4D580";

//! What every rasterizer has to pass: the same scenes, compared with the reference in f64.
//!
//! Part of the library, so that other crates can hold their rasterizers to it:
//!
//! ```ignore
//! let findings = conformance::check(&my_rasterizer, &Bounds { colour: 1e-4, ..Bounds::CPU })?;
//! assert!(findings.iter().all(Finding::passes), "{}", conformance::table(&findings));
//! ```
//!
//! Thresholds make pictures jump: an alpha that rounds to the other side of 1/255, or a transmittance to the other
//! side of 1e-4, changes a pixel by up to about a hundredth. Such pixels are counted apart ("flips"), and their
//! number and size have bounds of their own.

mod compare;
mod differences;
mod outputs;
mod scenes;

pub use compare::{Bounds, Finding, check, refusals};
pub use differences::{Agreement, central_differences};
pub use outputs::Outputs;
pub use scenes::{Case, cases};

/// Findings as a table for people.
pub fn table(findings: &[Finding]) -> String {
    let mut text = format!(
        "{:<18} {:<22} {:>10} {:>10} {:>7} {:>8}  {}\n",
        "scene", "quantity", "error", "bound", "flips", "allowed", "verdict"
    );
    for finding in findings {
        let verdict = if finding.passes() { "ok" } else { "FAILS" };
        text += &format!(
            "{:<18} {:<22} {:>10.2e} {:>10.2e} {:>7} {:>8}  {verdict}\n",
            finding.case,
            finding.quantity,
            finding.error,
            finding.bound,
            finding.flips,
            finding.flips_allowed
        );
    }
    text
}

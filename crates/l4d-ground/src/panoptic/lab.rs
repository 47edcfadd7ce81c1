//! Colours as people tell them apart: CIE L*a*b* (1976) of display colours, D65.

/// sRGB byte to linear light (IEC 61966-2-1).
fn linear(byte: u8) -> f32 {
    let value = f32::from(byte) / 255.0;
    if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// L*a*b* of a display colour.
pub(super) fn lab_of(rgb: [u8; 3]) -> [f32; 3] {
    let [r, g, b] = rgb.map(linear);
    let x = (0.412_456 * r + 0.357_576 * g + 0.180_438 * b) / 0.950_47;
    let y = 0.212_673 * r + 0.715_152 * g + 0.072_175 * b;
    let z = (0.019_334 * r + 0.119_192 * g + 0.950_304 * b) / 1.088_83;
    let root = |value: f32| {
        if value > 216.0 / 24_389.0 { value.cbrt() } else { (24_389.0 / 27.0 * value + 16.0) / 116.0 }
    };
    let [x, y, z] = [x, y, z].map(root);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Distance of two colours (CIE 1976).
pub(super) fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f32>().sqrt()
}

/// [`lab_of`] tabulated over colours of five bits a channel: pictures have many pixels and few colours.
#[derive(Debug)]
pub(super) struct LabTable(Vec<[f32; 3]>);

impl LabTable {
    pub(super) fn new() -> Self {
        let byte = |bits: usize| ((bits & 31) << 3 | 4) as u8;
        Self((0..1 << 15).map(|code| lab_of([byte(code >> 10), byte(code >> 5), byte(code)])).collect())
    }

    /// L*a*b* of the nearest colour of the table.
    pub(super) fn at(&self, rgb: [u8; 3]) -> [f32; 3] {
        let [r, g, b] = rgb.map(|byte| usize::from(byte >> 3));
        self.0.get(r << 10 | g << 5 | b).copied().unwrap_or_default()
    }
}

impl Default for LabTable {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_by_the_book() {
        // Reference values of the CIE formulas with D65: white, and sRGB red.
        assert!(distance(lab_of([255; 3]), [100.0, 0.0, 0.0]) < 0.1);
        assert!(distance(lab_of([255, 0, 0]), [53.24, 80.09, 67.20]) < 0.1);
        assert!(distance(lab_of([0; 3]), [0.0; 3]) < 0.1);
        let table = LabTable::new();
        assert!(distance(table.at([200, 60, 30]), lab_of([200, 60, 30])) < 3.0);
    }
}

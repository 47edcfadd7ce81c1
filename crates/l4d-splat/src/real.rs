//! The two floating-point widths in which the reference computes.

use std::fmt::Debug;

use num_traits::Float;

/// `f32` or `f64`, with conversions that cannot fail.
pub trait Real: Float + Debug + Default + Send + Sync + 'static {
    /// The nearest value of this width.
    fn of(value: f64) -> Self;
    /// The value as `f64`; exact.
    fn wide(self) -> f64;
    /// The nearest `f32`.
    fn narrow(self) -> f32;
}

impl Real for f32 {
    fn of(value: f64) -> Self {
        value as Self
    }

    fn wide(self) -> f64 {
        f64::from(self)
    }

    fn narrow(self) -> f32 {
        self
    }
}

impl Real for f64 {
    fn of(value: f64) -> Self {
        value
    }

    fn wide(self) -> f64 {
        self
    }

    fn narrow(self) -> f32 {
        self as f32
    }
}

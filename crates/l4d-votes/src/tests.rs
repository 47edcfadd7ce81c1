//! A whole round through its files: against a slow reference, against a second implementation of the statistics, and
//! through `kill -9`.

mod coefficients;
mod kill;
mod reference;

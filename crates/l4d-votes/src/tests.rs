//! A whole round through its files: against a slow reference, and through `kill -9` and a full disk.

mod kill;
mod reference;

//! Scenes that others recorded, read into the layout of l4d.

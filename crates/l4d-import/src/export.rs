//! A rendered scene in the layouts that other trainers read.

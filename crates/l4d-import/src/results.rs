//! Results that other methods left on disk, read into answers to the queries of l4d.

//! The whole suite in one binary, so that it links once.

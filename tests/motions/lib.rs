//! Tests that integrate long motions: they stand in files of their own, and are optimised.

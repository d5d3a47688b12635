//! Tests that integrate long motions, in a package of their own that is optimised.

//! Polynomial normal form over atoms, for reading.

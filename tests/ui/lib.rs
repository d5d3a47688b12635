//! Empty library of the package that contains the test `ui`.

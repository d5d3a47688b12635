//! Nothing but the place of the test `ui`.

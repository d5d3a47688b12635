//! What a mechanism may look like, and what its program may call its own things: all of this compiles without
//! a warning.

mod forms_of_a_struct;
mod fragments;
mod names_of_generated_values;
mod own_names;

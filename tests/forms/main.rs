//! Forms of a mechanism, and names that a program may use for its own items. All of this compiles without a
//! warning.

mod forms_of_a_struct;
mod fragments;
mod names_of_generated_values;
mod own_names;

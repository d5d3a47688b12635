//! Published problems and closed-form solutions. The values of `data/problems` state their sources; each test
//! has the tolerance that its problem states.

mod pendulums;
mod puma;
mod springs;
mod tops;

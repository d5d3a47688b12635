//! Published problems and closed forms. The numbers of `data/problems` name their sources; each test has the
//! tolerance that its problem states.

mod pendulums;
mod puma;
mod springs;
mod tops;

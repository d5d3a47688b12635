//! The language as data: functions, solids, surfaces, rotations and elements are rows of tables. A row has
//! the name, its synonyms in other tools, the arguments with their dimensions, and the properties that other
//! stages need. The parser turns names into ids of rows; later stages match on ids and read the rows.

/// Declares a table: an enum with an id for each row, and the rows. Rows have the fields `name` and
/// `synonyms`: the words of other tools, lower case without underscores, separated by spaces.
macro_rules! table {
    ($(#[$about:meta])* $ids:ident: $row:ty { $($(#[$doc:meta])* $id:ident = $value:expr;)+ }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $ids {
            $($(#[$doc])* $id,)+
        }

        impl $ids {
            /// The ids of all rows, in the order of the table.
            pub const ALL: &'static [$ids] = &[$($ids::$id),+];

            /// Returns the table row of an id.
            pub fn row(self) -> &'static $row {
                match self {
                    $($ids::$id => {
                        static ROW: $row = $value;
                        &ROW
                    })+
                }
            }

            /// Returns the name of a row.
            pub fn name(self) -> &'static str {
                self.row().name
            }

            /// Returns the id of the row with this name.
            pub fn find_by_name(name: &str) -> Option<$ids> {
                Self::ALL.iter().copied().find(|id| id.name() == name)
            }

            /// Returns the names of all rows of the table.
            pub fn names<'a>() -> impl Iterator<Item = &'a str> {
                Self::ALL.iter().map(|id| id.name())
            }

            /// Returns the synonyms of all rows, each with the row's name.
            pub fn synonyms() -> impl Iterator<Item = (&'static str, &'static str)> {
                Self::ALL.iter().map(|id| (id.row().synonyms, id.name())).filter(|(said, _)| !said.is_empty())
            }
        }
    };
}

/// Words, separated by spaces, and what is meant by them: a word of the language, or a sentence if it holds a
/// space. Words are looked up in lower case and without underscores.
pub type WordsWithMeanings = &'static [(&'static str, &'static str)];

pub mod argument;
pub mod callable;
pub mod dimension;
pub mod elements;
pub mod functions;
pub mod methods;
pub mod names;
pub mod ratio;
pub mod rotations;
pub mod solids;
pub mod surfaces;

pub use argument::{Argument, ArgumentKind};
pub use callable::Callable;
pub use elements::{
    ArgumentQuantity, ArgumentRelation, ElementKind, ForceKind, ForceLawVariables, JointKind, Key, OtherKind,
};
pub use functions::{FunctionDependence, FunctionId, UnitRule};
pub use methods::BodyOrInertiaMethod;
pub use names::{Builtin, axis_index_of_name};
pub use rotations::Rotation;
pub use solids::Solid;
pub use surfaces::{MAX_FACE_POINTS, SurfaceFeatureCounts, SurfaceId};

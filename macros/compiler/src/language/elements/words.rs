//! Help texts for arguments of other tools that several elements share.

/// Names of other tools for the argument `on`.
pub const ON: &str = "joint joints body bodies target coordinate applied frame";

/// Help text for a point that is written as a separate argument.
pub const AT: &str = "the point is written after the body: `on = body.at(length * x)`";

/// Help text for limits that are declared for an input.
pub const SATURATION: &str = "inputs have no limits: bound the value in the controller, or write `value = \
                              max(min(u, high), low)`";

/// Help text for an inertance in an element other than `Inerter`.
pub const NO_INERTANCE: &str = "resistance to accelerations is a separate `Inerter`";

/// Help text of the error for the position of a joint that is written as an argument.
pub const END: &str = "the position is part of the end of the joint: `parent.at(length * x) -> child`";

/// Help text of the error for the orientation of a joint that is written as an argument.
pub const TURNED: &str = "axes are rotated at the end of the joint: `parent.rotated(z(angle)) -> child`";

/// Help text of the error for limits that are written as arguments of a joint, whose name is `NAME`.
pub const LIMITED: &str = "a limit is a separate field: `#[limit(on = NAME, from = a, to = b)] range: Limit`";

/// Help text of the error for a gear ratio that is written as an argument.
pub const RATIO: &str =
    "a ratio of two coordinates is a constraint: `#[constraint(second + ratio * first = 0)] gear: Holonomic`";

/// Help text of the error for the joint of a body that is written as an argument.
pub const ENDS: &str =
    "a body is connected by a joint, a separate field: `#[joint(parent -> child, about = z)] hinge: Pin`";

/// Help text for single moments of inertia as arguments.
pub const MATRIX: &str =
    "moments of inertia are given together: `inertia = diagonal(xx, yy, zz)`, or a 3×3 matrix";

/// Help text of the error for the position of a body that is written as an argument.
pub const PLACED: &str =
    "a body is placed by its joint: `#[joint(parent.at(length * x) -> child, about = z)]`";

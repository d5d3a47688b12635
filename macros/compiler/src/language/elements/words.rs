//! Words of other tools that several elements share, and what is meant by them.

/// What an element acts on.
pub const ON: &str = "joint joints body bodies target coordinate applied frame";

/// Where a point is written.
pub const AT: &str = "the point stands behind the body: `on = body.at(length * x)`";

/// What bounds an input.
pub const SATURATION: &str = "inputs have no limits: bound the value before it goes in, or write one, `value = max(min(u, high), low)`";

/// What resists accelerations.
pub const NO_INERTANCE: &str = "what resists accelerations is an `Inerter`, a field of its own";

/// Where the place of a joint is written.
pub const END: &str = "the place stands at the end of the joint: `parent.at(length * x) -> child`";

/// Where the axes of a joint are rotated.
pub const TURNED: &str = "axes are turned at the end of the joint: `parent.rotated(z(angle)) -> child`";

/// What limits a joint; `NAME` is its name.
pub const LIMITED: &str =
    "a limit is a field of its own: `#[limit(on = NAME, from = a, to = b)] range: Limit`";

/// What couples two coordinates.
pub const RATIO: &str =
    "a ratio of two coordinates is a constraint: `#[constraint(second + ratio * first = 0)] gear: Holonomic`";

/// What holds a body.
pub const ENDS: &str =
    "a body is held by a joint, a field of its own: `#[joint(parent -> child, about = z)] hinge: Pin`";

/// How moments of inertia are written.
pub const MATRIX: &str =
    "moments of inertia stand together: `inertia = diagonal(xx, yy, zz)`, or a 3×3 matrix";

/// What places a body.
pub const PLACED: &str =
    "a body is placed by its joint: `#[joint(parent.at(length * x) -> child, about = z)]`";

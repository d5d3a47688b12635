//! Tables of words from other tools and textbooks, with their meanings in the language.

use crate::language::WordsWithMeanings;
use crate::language::elements::words::RATIO;

const ONE_SIDED_HELP: &str = "an element that only pulls is a `Spring` given by its energy: `energy = k / 2 \
                              * pow(max(stretch, 0), 2)`";
const END_STOP_HELP: &str = "a rigid end stop is a `Limit` with `restitution`: `#[limit(on = joint, from = \
                             a, to = b, restitution = 0)]`; a soft one is a `Spring` given by its energy: \
                             `energy = k / 2 * pow(min(stretch - low, 0), 2)`";
const CONTROL_HELP: &str = "the output of a controller is an input, `Force`, `Torque` or `Input`; the \
                            controller itself is your own Rust code";
const SHAPE_HELP: &str =
    "shapes are not drawn: a body has a mass and an inertia, as in `inertia = cuboid(m, a, b, c)`";
const GROUND_HELP: &str = "`ground` exists in every mechanism: a joint connects a body to it, as in `ground \
                           -> body`";
const OUTPUT_HELP: &str = "a computed quantity is a `Scalar` or `Vector` with `#[output(…)]`";
const CONTACT_HELP: &str = "surfaces that can separate are a `Contact`: `#[contact(ball.sphere(radius), \
                            ground.plane(z), friction = mu, restitution = e)]`; surfaces in permanent \
                            contact are `Rolling` or `Slipping`";
const TIME_HELP: &str = "time is `t` in every expression; `#[mechanism]` needs no field for it";
const CONSTRAINT_HELP: &str = "a constraint is `Holonomic`, `Nonholonomic`, `Rolling` or `Slipping`";

/// Synonyms of field types, without the suffix `joint`, with the type that is suggested.
pub const ELEMENTS: WordsWithMeanings = &[
    ("mass", "a mass is a `Body` if it is extended or rotates, a `Particle` if it is a point"),
    (
        "joint",
        "a joint is a `Pin`, `Sleeve`, `Screw`, `Collar`, `Slot`, `Universal`, `Ball`, `Planar`, `Stage`, \
         `Free` or `Weld`",
    ),
    (
        "springdamper damperspring springdashpot strut suspension",
        "it is a `Spring` and a `Dashpot`, a field for each",
    ),
    (
        "expression definition define",
        "a name for an expression is a `Scalar` or `Vector` with `#[define(…)]`",
    ),
    ("output outputs sensor measurement probe observer", OUTPUT_HELP),
    ("constraint constraints", CONSTRAINT_HELP),
    ("gear gears gearbox belt pulley transmission differential coupler mimic rackandpinion", RATIO),
    ("rope cable tendon string chain wire muscle thread", ONE_SIDED_HELP),
    ("stop endstop bumper hardstop", END_STOP_HELP),
    ("contact contacts collision collider impact terrain heightfield heightmap hfield", CONTACT_HELP),
    (
        "wheel roller tire tyre",
        "a wheel is a `Body` on a joint, and a `Rolling`: `#[constraint(rolls(wheel.circle(radius, y), \
         ground.plane(z)))]`",
    ),
    ("controller pid regulator", CONTROL_HELP),
    ("geom geometry visual mesh shape collisionshape", SHAPE_HELP),
    ("ground world base earth inertialframe newtonianframe", GROUND_HELP),
    (
        "lagrangian hamiltonian lagrange kane",
        "equations follow from bodies, joints and forces; an energy of your own is a `Potential`",
    ),
    ("time", TIME_HELP),
    ("real float double number param parameter parameters constant const length angle f16 f128 f80 t", "f64"),
];

const INTEGRATION_HELP: &str = "the equations are solved where they are used: `linkwork::integrate` and \
                                `linkwork::simulate` hold the methods";
const FORMAT_HELP: &str = "URDF, MJCF and SDF files can be read: `urdf = \"path/to/robot.urdf\"`, `mjcf = \
                           \"path/to/robot.xml\"`, `sdf = \"path/to/robot.sdf\"`";
const XACRO_HELP: &str = "expand the template first, `xacro robot.urdf.xacro > robot.urdf`, and name the \
                          result: `urdf = \"path/to/robot.urdf\"`";

/// Synonyms of options of `#[mechanism]` with a value, with the option that is suggested.
pub const OPTIONS: WordsWithMeanings = &[
    ("g grav gravitation gravityvector", "did you mean `gravity`? it is a vector: `gravity = -9.81 * y`"),
    ("file path model robot filename source", "urdf"),
    ("xml usd dae", FORMAT_HELP),
    ("sdformat gazebo", "sdf"),
    ("mujoco mjb", "mjcf"),
    ("xacro", XACRO_HELP),
    ("precision type float real dtype", "scalar"),
    ("floatingbase freebase floating freeflyer rootjoint", "did you mean `base = free`?"),
    ("fixedbase", "did you mean `base = fixed`?"),
    ("solver integrator method dt step timestep stepsize", INTEGRATION_HELP),
    ("unit units", "all quantities are in SI units, angles in radians"),
    ("name", "the struct's name is that of the mechanism"),
    ("damping friction passivejoints", "passive"),
    ("actuators motors", "inputs"),
    ("locked frozen", "lock"),
    ("constraints algorithm", "formulation"),
    ("print printed latex", "equations"),
    ("deterministic determinism reproducible bitwise fma fastmath", "arithmetic"),
    ("trustinertia", "did you mean `inertia = trust`?"),
];

/// Synonyms of options of `#[mechanism]` without a value, with the option that is suggested.
pub const REQUESTS: WordsWithMeanings = &[
    (
        "derivative jacobian jacobians gradient gradients linearize linearise linearization linear \
         sensitivity autodiff diff",
        "derivatives",
    ),
    ("simd lanes vectorize vectorise parallel", "batch"),
    ("sparse compressed", "packed"),
    ("draw picture view viewer visual visuals render", "drawing"),
    ("momentum centroid", "centroidal"),
    ("hamiltonian canonical phasespace", "hamilton"),
    ("routhian reduction ignorable reduced", "routh"),
    ("conservation integrals invariants cyclic", "conserved"),
    ("identification parameters basis", "regressor"),
    ("precompute cache prepared", "prepare"),
    ("reproducible deterministic bitwise", "write `arithmetic = reproducible`"),
    ("nogravity weightless", "without `gravity` there is none: remove it"),
    ("f32 single", "write `scalar = f32`, or give the parameters this type"),
    ("f64 double", "write `scalar = f64`, or give the parameters this type"),
    ("floatingbase floating freebase", "write `base = free` together with `urdf = \"…\"`"),
    (
        "energy kineticenergy potentialenergy forwarddynamics inversedynamics dynamics massmatrix",
        "every mechanism has it: remove the option",
    ),
];

/// Synonyms of formulations of constrained motion, with the formulation that is suggested.
pub const FORMULATIONS: WordsWithMeanings = &[
    ("lagrange lagrangian lagrangemultipliers dae multiplier", "multipliers"),
    ("kane independent minimal reduced speed ode", "speeds"),
];

/// Synonyms of functions in expressions, with the function that is suggested.
pub const FUNCTIONS: WordsWithMeanings = &[
    ("arctan", "atan"),
    ("arcsin", "asin"),
    ("arccos", "acos"),
    ("log loge", "ln"),
    ("log10 log2", "write `ln(a) / ln(10)`"),
    ("sgn sign", "signum"),
    ("sqr square squared", "write `pow(a, 2)` or `a * a`"),
    ("cube", "write `pow(a, 3)`"),
    ("root squareroot", "sqrt"),
    ("cbrt", "write `pow(a, 1 / 3)`"),
    ("cot", "write `1 / tan(a)`"),
    ("sec", "write `1 / cos(a)`"),
    ("csc cosec", "write `1 / sin(a)`"),
    ("hypot", "write `sqrt(a * a + b * b)`"),
    ("clamp clip saturate limit sat", "write `min(max(a, low), high)`"),
    ("heaviside step", "write `(1 + signum(a)) / 2`"),
    (
        "floor ceil round mod rem fmod",
        "expressions are smooth: compute steps and remainders in your own Rust code",
    ),
    ("fabs magnitudeof", "abs"),
    ("norm2 norm22 lengthsquared sqnorm squarednorm", "write `dot(v, v)`"),
    ("vec vec3 vector vector3 matrix", "a vector is written `[a, b, c]` or `a * x + b * y + c * z`"),
    (
        "rotx roty rotz rx ry rz rpy euler quat",
        "rotations are allowed in `.rotated(z(angle))` and in `#[frame(ground, z(angle))]`",
    ),
    ("diag", "diagonal"),
    ("ifelse where when piecewise pieces select", "a piecewise law is written `if a < b { … } else { … }`"),
];

const SI_HELP: &str = "numbers have no units: all quantities are in SI units, angles in radians or \
                       `degrees(90)`; a parameter is a field of this name, of type `f64`";
const VALUE_HELP: &str = "a value is a number, a parameter, a coordinate or an expression of them";

/// Synonyms of names in expressions, with the expression that is suggested.
pub const NAMES: WordsWithMeanings = &[
    ("time", "t"),
    ("mpi π", "pi"),
    ("tau twopi", "write `2 * pi`"),
    ("deg degree degrees °", "write `degrees(90)` for an angle in degrees"),
    ("rad radians", "angles are in radians: remove it"),
    ("kg m meter metre meters s sec n nm mm cm gram newton si", SI_HELP),
    ("true false", VALUE_HELP),
    ("inf infinity nan none null", VALUE_HELP),
    ("ex e1 xhat ux unitx xaxis", "x"),
    ("ey e2 yhat uy unity yaxis", "y"),
    ("ez e3 zhat uz unitz zaxis", "z"),
    (
        "i j k up down left right forward e1 e2 e3 axis",
        "the axes are `x`, `y` and `z`, those of a body `body.x`; downwards is `-y` or `-z`",
    ),
    ("xy", "write `(x, y)` for two axes"),
    ("yz", "write `(y, z)` for two axes"),
    ("xz", "write `(x, z)` for two axes"),
    ("xyz", "write `(x, y, z)` for three axes"),
    (
        "q qd u dq qdot",
        "coordinates have names: the joint's, or `joint.x` if it has several; `rate(joint)` is a rate",
    ),
];

/// Greek letters, with the names that replace them.
pub const GREEK: &[(&str, &str)] = &[
    ("α", "alpha"),
    ("β", "beta"),
    ("γ", "gamma"),
    ("δ", "delta"),
    ("ε", "epsilon"),
    ("ζ", "zeta"),
    ("η", "eta"),
    ("θ", "theta"),
    ("κ", "kappa"),
    ("λ", "lambda"),
    ("μ", "mu"),
    ("ν", "nu"),
    ("ξ", "xi"),
    ("ρ", "rho"),
    ("σ", "sigma"),
    ("τ", "tau"),
    ("φ", "phi"),
    ("χ", "chi"),
    ("ψ", "psi"),
    ("ω", "omega"),
    ("Ω", "omega"),
];

/// Synonyms of solids in `inertia = …`, with the solid that is suggested.
pub const SOLIDS: WordsWithMeanings = &[
    ("point particle pointmass none zero", "a point has no inertia: leave `inertia` out"),
    ("matrix tensor full", "write the matrix itself, `[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]`"),
];

/// Synonyms of methods of a body, with the method that is suggested.
pub const METHODS: WordsWithMeanings = &[
    ("pos position point offset translate translated from shift origin", "at"),
    ("rotate rot rotation turned turn tilted rpy", "rotated"),
];

/// Synonyms of members of a body, with the expression that is suggested; `NAME` is the body's name.
pub const MEMBERS: WordsWithMeanings = &[
    ("position pos r origin p", "its position is `r(NAME / ground)`"),
    ("velocity vel v speed", "its velocity is `v(NAME / ground / ground)`"),
    ("acceleration acc", "its acceleration is `a(NAME / ground / ground)`"),
    ("omega w angularvelocity rate", "its angular velocity is `omega(NAME / ground)`"),
    (
        "mass m inertia com length radius l i height width",
        "its properties have no names here: use the parameter",
    ),
];

/// Words that users write for the body that is being declared.
pub const OWN: WordsWithMeanings =
    &[("body this own local frame me", "the only axes available here are `x`, `y` and `z`")];

/// Synonyms of methods of numbers and coordinates, with the method that is suggested.
pub const NUMBER_METHODS: WordsWithMeanings = &[("powi powf powu", "write `pow(a, n)`")];

/// Synonyms of methods of coordinates, with the expression that is suggested; `NAME` is the coordinate.
pub const RATES: WordsWithMeanings = &[("dot rate diff velocity speed dt", "write `rate(NAME)`")];

/// Names of the ground in other tools.
pub const BODIES: WordsWithMeanings = &[(
    "world base baselink earth origin inertial fixed n newtonian globe wall floor map odom frame static",
    "ground",
)];

/// Words of other tools for rotations by three angles, with the form that is suggested.
pub const ROTATIONS: WordsWithMeanings = &[(
    "rpy euler rollpitchyaw",
    "roll, pitch and yaw are rotations about body-fixed axes in the opposite order: `z(yaw), y(pitch), \
     x(roll)`",
)];

//! The tables: what is said → what is meant.

/// Words, separated by spaces, and what is meant by them: a word of the language, or a sentence if it holds a
/// space. Words are looked up in lower case and without underscores.
pub type Words = &'static [(&'static str, &'static str)];

const ONE_SIDED: &str =
    "what only pulls is a `Spring` given by its energy: `energy = k / 2 * pow(max(stretch, 0), 2)`";
const END_STOP: &str = "a rigid end stop is a `Limit` with `restitution`: `#[limit(on = joint, from = a, to = b, restitution = 0)]`; a soft one is a `Spring` given by its energy: `energy = k / 2 * pow(min(stretch - low, 0), 2)`";
const LIMITED: &str = "a limit is a field of its own: `#[limit(on = NAME, from = a, to = b)] range: Limit`";
const RATIO: &str =
    "a ratio of two coordinates is a constraint: `#[constraint(second + ratio * first = 0)] gear: Holonomic`";
const CONTROL: &str = "what a controller decides is an input, `Force`, `Torque` or `Input`; the controller itself is Rust of your own";
const SHAPE: &str =
    "shapes are not drawn: a body has a mass and an inertia, as in `inertia = cuboid(m, a, b, c)`";
const GROUND: &str = "`ground` is there already: a joint from it holds a body, as in `ground -> body`";
const SEEN: &str = "what is computed for you is a `Scalar` or `Vector` with `#[output(…)]`";
const TOUCH: &str = "surfaces that may part are a `Contact`: `#[contact(ball.sphere(radius), ground.plane(z), friction = mu, restitution = e)]`; those that stay in touch are `Rolling` or `Slipping`";
const TIME: &str = "time is `t` in every expression; `#[mechanism]` needs no field for it";
const CONSTRAINT: &str = "a constraint is `Holonomic`, `Nonholonomic`, `Rolling` or `Slipping`";

/// Types of fields, without the word `joint`.
pub const ELEMENTS: Words = &[
    (
        "revolute hinge continuous rotary rotational rotation rotating pivot axle bearing turn turning swivel",
        "Pin",
    ),
    ("prismatic slider slide sliding translational translation linear rail piston telescopic", "Sleeve"),
    ("helical helix leadscrew ballscrew nut", "Screw"),
    ("cylindrical cylinder", "Collar"),
    ("cardan hooke gimbal cv", "Universal"),
    ("spherical socket ballsocket ballandsocket quaternion", "Ball"),
    ("floating floatingbase freebase sixdof 6dof freeflyer freeflying unconstrained bushing", "Free"),
    ("fixed rigid weld welded locked lock glue fix", "Weld"),
    ("xystage xyzstage xy xyz cartesian gantry translation3d", "Stage"),
    ("dualsleevepin planar2d", "Planar"),
    ("link rigidbody body3d part segment solid linkage inertial multibody", "Body"),
    ("pointmass masspoint bob bead", "Particle"),
    ("mass", "a mass is a `Body` if it has a size or turns, `Particle` if it is a point"),
    (
        "joint",
        "a joint is a `Pin`, `Sleeve`, `Screw`, `Collar`, `Slot`, `Universal`, `Ball`, `Planar`, `Stage`, `Free` or `Weld`",
    ),
    ("damper viscousdamper damping shock shockabsorber resistance drag", "Dashpot"),
    (
        "springdamper damperspring springdashpot strut suspension",
        "it is a `Spring` and a `Dashpot`, a field for each",
    ),
    (
        "torsionspring torsionalspring rotationalspring linearspring coilspring elastic elasticity compliance",
        "Spring",
    ),
    ("motor actuator servo moment couple drive servomotor", "Torque"),
    ("thruster thrust load push pull wind", "Force"),
    ("coulombfriction dryfriction coulomb stiction brake", "Friction"),
    (
        "symbol symbols dynamicsymbol dynamicsymbols generalizedcoordinate generalisedcoordinate variable dof unknown",
        "Coordinate",
    ),
    ("control signal command controlinput inputs", "Input"),
    ("referenceframe axes coordinatesystem csys basis", "Frame"),
    ("site marker location position landmark waypoint", "Point"),
    ("potentialenergy energy", "Potential"),
    ("dissipation dissipationfunction rayleighdissipation", "Rayleigh"),
    ("vector3 vec3 vector3d vec", "Vector"),
    (
        "generalizedspeed generalisedspeed quasivelocity quasicoordinate pseudovelocity motionvariable speeds",
        "Speed",
    ),
    (
        "expression definition define",
        "a name for an expression is a `Scalar` or `Vector` with `#[define(…)]`",
    ),
    ("output outputs sensor measurement probe observer", SEEN),
    ("holonomicconstraint equation loop closure distance", "Holonomic"),
    ("nonholonomicconstraint skate noslip", "Nonholonomic"),
    ("constraint constraints", CONSTRAINT),
    ("gear gears gearbox belt pulley transmission differential coupler mimic rackandpinion", RATIO),
    ("rope cable tendon string chain wire muscle thread", ONE_SIDED),
    ("limits range bounds jointlimit jointlimits", "Limit"),
    ("stop endstop bumper hardstop", END_STOP),
    ("contact contacts collision collider impact terrain heightfield heightmap hfield", TOUCH),
    (
        "wheel roller tire tyre",
        "a wheel is a `Body` on a joint, and a `Rolling`: `#[constraint(rolls(wheel.circle(radius, y), ground.plane(z)))]`",
    ),
    ("controller pid regulator", CONTROL),
    ("geom geometry visual mesh shape collisionshape", SHAPE),
    ("ground world base earth inertialframe newtonianframe", GROUND),
    (
        "lagrangian hamiltonian lagrange kane",
        "equations follow from bodies, joints and forces; an energy of your own is a `Potential`",
    ),
    ("time", TIME),
    ("real float double number param parameter parameters constant const length angle f16 f128 f80 t", "f64"),
];

const ENDS: &str =
    "a body is held by a joint, a field of its own: `#[joint(parent -> child, about = z)] hinge: Pin`";
const MATRIX: &str = "moments of inertia stand together: `inertia = diagonal(xx, yy, zz)`, or a 3×3 matrix";
const PLACED: &str = "a body is placed by its joint: `#[joint(parent.at(length * x) -> child, about = z)]`";

/// Arguments of a body.
pub const BODY: Words = &[
    ("m weight masse", "mass"),
    ("cog cm cg centre center centerofmass centreofmass massoffset cofm comoffset", "com"),
    ("i j ic icm moi momentofinertia inertiatensor inertiamatrix geometry shape solid", "inertia"),
    ("ixx iyy izz ixy ixz iyz jxx jyy jzz", MATRIX),
    ("length size l height width", "a size belongs to a solid, as in `inertia = rod(m, l, y)`"),
    ("radius diameter r", "a size belongs to a solid, as in `inertia = sphere(m, r)`"),
    ("density rho", "the mass is given itself: `mass = density * volume`"),
    ("position pos origin xyz translation location", PLACED),
    ("parent child joint on base", ENDS),
    ("color colour visual name", "nothing is drawn: remove it"),
];

/// Arguments of a particle.
pub const PARTICLE: Words = &[
    ("m weight", "mass"),
    ("position pos xyz r where point location place", "at"),
    ("on body parent", "the body stands before the vector: `at = body.at(length * x)`"),
    ("com inertia", "a particle is a point; a `Body` has a centre of mass and an inertia"),
];

const END: &str = "the place stands at the end of the joint: `parent.at(length * x) -> child`";
const TURNED: &str = "axes are turned at the end of the joint: `parent.rotated(z(angle)) -> child`";

/// Arguments of a joint; `NAME` is its name.
pub const JOINT: Words = &[
    ("axis axes direction dir rotationaxis hingeaxis normal", "about"),
    ("axis axes direction dir slideaxis", "along"),
    ("origin pos position at anchor offset xyz point translation location", END),
    ("rpy orientation angle rotation axes rotated euler quat quaternion tilt", TURNED),
    (
        "damping damper c viscous",
        "a joint moves freely; a damper is a field of its own: `#[acts(on = NAME, damping = c)] damper: Dashpot`",
    ),
    (
        "stiffness spring k",
        "a joint moves freely; a spring is a field of its own: `#[acts(on = NAME, stiffness = k)] spring: Spring`",
    ),
    (
        "friction coulomb frictionloss",
        "a joint moves freely; friction is a field of its own: `#[acts(on = NAME, coulomb = f)] friction: Friction`",
    ),
    (
        "torque motor actuator effort drive",
        "what drives a joint is a field of its own: `#[acts(on = NAME)] motor: Torque`",
    ),
    ("force", "what drives a joint is a field of its own: `#[acts(on = NAME)] motor: Force`"),
    (
        "limit limits lower upper range min max from to maxspeed maxvelocity maxeffort maxtorque maxforce",
        LIMITED,
    ),
    ("ratio mimic gear", RATIO),
    (
        "coordinate coordinates q name symbol speed speeds",
        "the joint's name is its coordinate, `rate(NAME)` its rate",
    ),
    (
        "driven prescribed",
        "a motion that is given is a body placed by time: `#[body(massive, at = …, frame = …)]`",
    ),
];

/// What an element acts on, in all of them.
const ON: &str = "joint joints body bodies target coordinate applied frame";

/// Arguments of a spring.
pub const SPRING: Words = &[
    (ON, "on"),
    ("points ends connects", "between"),
    ("k stiff springconstant springrate rate constant coefficient", "stiffness"),
    (
        "length l l0 x0 restlength naturallength unstretchedlength freelen rest natural free equilibrium",
        "free_length",
    ),
    ("angle theta0 phi0 restangle naturalangle q0 rest natural free equilibrium", "free_angle"),
    ("inertance inerter", "what resists accelerations is an `Inerter`, a field of its own"),
    ("damping c d damper", "a spring does not damp: put a `Dashpot` beside it, a field of its own"),
    ("f law", "force"),
    ("potential u", "energy"),
];

/// Arguments of a dashpot.
pub const DASHPOT: Words = &[
    (ON, "on"),
    ("points ends connects", "between"),
    ("c d b damp dampingcoefficient coefficient viscosity viscous resistance", "damping"),
    ("inertance inerter", "what resists accelerations is an `Inerter`, a field of its own"),
    ("coulomb friction mu dry", "dry friction is a `Friction`, a field of its own"),
    ("stiffness k", "a dashpot does not spring back: put a `Spring` beside it, a field of its own"),
    ("f law", "force"),
];

/// Arguments of an inerter.
pub const INERTER: Words =
    &[(ON, "on"), ("points ends connects", "between"), ("b mass m inertia i", "inertance")];

/// Arguments of friction.
pub const FRICTION: Words = &[
    (ON, "on"),
    (
        "mu coefficient f friction force torque kinetic dynamic sliding normal",
        "did you mean `coulomb`? it is a force or a torque: the coefficient times the normal force",
    ),
    ("static breakaway stick fs", "stiction"),
    ("damping c d b", "viscous"),
    ("stribeck vs", "stribeck_speed"),
    ("smoothing regularization regularisation velocity eps", "speed"),
];

/// Arguments of gravity and of attraction.
pub const GRAVITY: Words = &[
    ("g constantg gravitationalconstant gamma", "constant"),
    ("gm standardgravitationalparameter parameter", "mu"),
    ("k constant charge", "strength"),
    ("from to bodies points on", "between"),
];

const AT: &str = "the point stands behind the body: `on = body.at(length * x)`";
const SATURATION: &str = "inputs have no limits: bound the value before it goes in, or write one, `value = max(min(u, high), low)`";

/// Arguments of a force.
pub const FORCE: Words = &[
    (ON, "on"),
    ("axis direction dir about", "along"),
    ("magnitude force f vector expression", "value"),
    ("at point position location", AT),
    ("max min limit limits saturation", SATURATION),
    ("points ends connects from to", "between"),
];

/// Arguments of a torque.
pub const TORQUE: Words = &[
    (ON, "on"),
    ("axis direction dir along", "about"),
    ("magnitude torque tau moment vector expression", "value"),
    ("at point position location", "a torque has no point: write `on = body`"),
    ("max min limit limits saturation", SATURATION),
];

/// Arguments of a contact.
pub const CONTACT: Words = &[
    ("mu muk coefficient frictioncoefficient coulomb kinetic kineticfriction sliding", "friction"),
    ("mus static staticfriction breakaway stick fs", "stiction"),
    ("spinning spin torsion torsionalfriction spinningfriction mutorsion drilling", "torsional"),
    ("rollingfriction rollingresistance resistance murolling roll", "rolling"),
    ("e cor bounce bounciness elasticity rebound restitutioncoefficient", "restitution"),
    ("k compliance rigidity", "stiffness"),
    ("damping c damper", "dissipation"),
    (
        "on between surfaces bodies radius r size",
        "both surfaces stand first: `ball.sphere(radius), ground.plane(z)`",
    ),
];

/// Arguments of a limit.
pub const LIMIT: Words = &[
    (ON, "on"),
    ("lower low min minimum least start lowerlimit", "from"),
    ("upper high max maximum most end upperlimit", "to"),
    ("velocity speed rate maxvelocity vmax maxrate", "max_speed"),
    ("effort force torque maxforce maxtorque fmax taumax", "max_effort"),
    (
        "stiffness damping",
        "a soft end stop is a `Spring` given by its energy: `energy = k / 2 * pow(min(stretch - low, 0), 2)`",
    ),
];

/// Arguments of a point.
pub const POINT: Words =
    &[("body parent frame link", "on"), ("pos position xyz offset location r vector", "at")];
/// Arguments of an output.
pub const VECTOR: Words = &[("frame axes basis in of expressedin resolved resolvedin", "resolved_in")];
/// Nothing is known.
pub const NO_WORDS: Words = &[];

const INTEGRATION: &str = "the equations are solved where they are used: `linkwork::integrate` and `linkwork::simulate` hold the methods";
const FORMATS: &str = "URDF, MJCF and SDF files can be read: `urdf = \"path/to/robot.urdf\"`, `mjcf = \"path/to/robot.xml\"`, `sdf = \"path/to/robot.sdf\"`";
const RUN_XACRO: &str = "expand the template first, `xacro robot.urdf.xacro > robot.urdf`, and name the result: `urdf = \"path/to/robot.urdf\"`";

/// Arguments of `#[mechanism]`.
pub const OPTIONS: Words = &[
    ("g grav gravitation gravityvector", "did you mean `gravity`? it is a vector: `gravity = -9.81 * y`"),
    ("file path model robot filename source", "urdf"),
    ("xml usd dae", FORMATS),
    ("sdformat gazebo", "sdf"),
    ("mujoco mjb", "mjcf"),
    ("xacro", RUN_XACRO),
    ("precision type float real dtype", "scalar"),
    ("floatingbase freebase floating freeflyer rootjoint", "did you mean `base = free`?"),
    ("fixedbase", "did you mean `base = fixed`?"),
    ("solver integrator method dt step timestep stepsize", INTEGRATION),
    ("unit units", "all quantities are in SI units, angles in radians"),
    ("name", "the struct's name is that of the mechanism"),
    ("damping friction passivejoints", "passive"),
    ("actuators motors", "inputs"),
    ("locked frozen", "lock"),
    ("constraints algorithm", "formulation"),
    ("print printed latex", "equations"),
    ("trustinertia", "did you mean `inertia = trust`?"),
];

/// Words of `#[mechanism]` that stand alone.
pub const REQUESTS: Words = &[
    (
        "derivative jacobian jacobians gradient gradients linearize linearise linearization linear sensitivity autodiff diff",
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
    ("nogravity weightless", "without `gravity` there is none: remove it"),
    ("f32 single", "write `scalar = f32`, or give the parameters this type"),
    ("f64 double", "write `scalar = f64`, or give the parameters this type"),
    ("floatingbase floating freebase", "write `base = free` beside `urdf = \"…\"`"),
    (
        "energy kineticenergy potentialenergy forwarddynamics inversedynamics dynamics massmatrix",
        "every mechanism has it: remove the word",
    ),
];

/// Ways to keep constraints.
pub const FORMULATIONS: Words = &[
    ("lagrange lagrangian lagrangemultipliers dae multiplier", "multipliers"),
    ("kane independent minimal reduced speed ode", "speeds"),
];

/// Functions of expressions.
pub const FUNCTIONS: Words = &[
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
        "expressions are smooth: steps and remainders are left to your own Rust",
    ),
    ("fabs magnitudeof", "abs"),
    ("norm2 norm22 lengthsquared sqnorm squarednorm", "write `dot(v, v)`"),
    ("vec vec3 vector vector3 matrix", "a vector is written `[a, b, c]` or `a * x + b * y + c * z`"),
    (
        "rotx roty rotz rx ry rz rpy euler quat",
        "rotations stand in `.rotated(z(angle))` and in `#[frame(ground, z(angle))]`",
    ),
    ("diag", "diagonal"),
    ("ifelse where when piecewise pieces select", "a law in pieces is written `if a < b { … } else { … }`"),
];

const SI: &str = "figures stand alone: all quantities are in SI units, angles in radians or `degrees(90)`; a parameter is a field of this name, of type `f64`";
const VALUE: &str = "a value is a number, a parameter, a coordinate or an expression of them";

/// Names in expressions.
pub const NAMES: Words = &[
    ("time", "t"),
    ("mpi π", "pi"),
    ("tau twopi", "write `2 * pi`"),
    ("deg degree degrees °", "write `degrees(90)` for an angle in degrees"),
    ("rad radians", "angles are in radians as they stand: remove it"),
    ("kg m meter metre meters s sec n nm mm cm gram newton si", SI),
    ("true false", VALUE),
    ("inf infinity nan none null", VALUE),
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

/// Greek letters, for names that spell them.
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

/// Solids of inertias.
pub const SOLIDS: Words = &[
    ("point particle pointmass none zero", "a point has no inertia: leave `inertia` out"),
    ("matrix tensor full", "write the matrix itself, `[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]`"),
];

/// What stands behind the dot of a body.
pub const METHODS: Words = &[
    ("pos position point offset translate translated from shift origin", "at"),
    ("rotate rot rotation turned turn tilted rpy", "rotated"),
];

/// Bodies.
pub const BODIES: Words = &[(
    "world base baselink earth origin inertial fixed n newtonian globe wall floor map odom frame static",
    "ground",
)];

/// Rotations.
pub const ROTATIONS: Words = &[(
    "rpy euler rollpitchyaw",
    "roll, pitch and yaw are turns about carried axes in the opposite order: `z(yaw), y(pitch), x(roll)`",
)];

use linkwork::mechanism;

/// Aircraft given by its non-dimensional derivatives about level cruise, including `α̇` derivatives.
///
/// Source: Etkin and Reid, *Dynamics of Flight* (1996), ch. 4 and 6; the values of
/// [`BOEING_747`](Self::BOEING_747) from their tables, those of [`NAVION`](Self::NAVION) from Nelson, *Flight
/// Stability and Automatic Control* (1998), appendix B.
///
/// - Axes: forward, right, down, also those of the ground; the stability axes of the cruise. Inputs:
///   `elevator`, `aileron`, `rudder`, rad; `thrust`, N, in addition to that of the cruise.
/// - With `û = V / u₀ − 1`, the dynamic pressure `Q = ½ ρ V²`, and rates made dimensionless by `2 V / c` and
///   `2 V / b`: forces and moments are `Q S`, `Q S c`, `Q S b` times linear coefficients, as
///   `C_Z = C_Z0 + C_Zu û + C_Zα α + (C_Zq q + C_Zα̇ α̇) c / (2 V) + C_Zδ δ`. In the cruise `C_X = 0` and
///   `C_Z0 = −m g / (Q S)`.
/// - Terms in `α̇` multiply accelerations and make the matrix of the accelerations unsymmetric.
#[mechanism(gravity = g * z, derivatives)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CruisingAircraft {
    /// Gravitational acceleration, m/s².
    pub g: f64,
    /// Mass of the aircraft, kg.
    pub mass: f64,
    /// Moment of inertia of the aircraft about its forward axis, kg·m².
    pub ixx: f64,
    /// Moment of inertia of the aircraft about its right axis, kg·m².
    pub iyy: f64,
    /// Moment of inertia of the aircraft about its downward axis, kg·m².
    pub izz: f64,
    /// Product of inertia of the handbooks, kg·m²: minus the entry of the inertia matrix in row x and column
    /// z.
    pub product: f64,
    /// Density of the air, kg/m³.
    #[unit(kg / m3)]
    pub density: f64,
    /// Cruise speed, m/s.
    pub cruise: f64,
    /// Wing area, m².
    #[unit(m2)]
    pub area: f64,
    /// Mean chord of the wing, m.
    #[unit(m)]
    pub chord: f64,
    /// Wing span, m.
    #[unit(m)]
    pub span: f64,
    /// Derivative `C_Xu` of the forward force with respect to the speed.
    pub cx_u: f64,
    /// Derivative `C_Xα` of the forward force with respect to the angle of attack.
    pub cx_alpha: f64,
    /// Derivative `C_Xδ` of the forward force with respect to the elevator angle.
    pub cx_elevator: f64,
    /// Derivative `C_Zu` of the downward force with respect to the speed.
    pub cz_u: f64,
    /// Derivative `C_Zα` of the downward force with respect to the angle of attack.
    pub cz_alpha: f64,
    /// Derivative `C_Zq` of the downward force with respect to the pitch rate.
    pub cz_q: f64,
    /// Derivative `C_Zα̇` of the downward force with respect to the rate of the angle of attack.
    pub cz_alpha_rate: f64,
    /// Derivative `C_Zδ` of the downward force with respect to the elevator angle.
    pub cz_elevator: f64,
    /// Derivative `C_mu` of the pitching moment with respect to the speed.
    pub cm_u: f64,
    /// Derivative `C_mα` of the pitching moment with respect to the angle of attack.
    pub cm_alpha: f64,
    /// Derivative `C_mq` of the pitching moment with respect to the pitch rate.
    pub cm_q: f64,
    /// Derivative `C_mα̇` of the pitching moment with respect to the rate of the angle of attack.
    pub cm_alpha_rate: f64,
    /// Derivative `C_mδ` of the pitching moment with respect to the elevator angle.
    pub cm_elevator: f64,
    /// Derivative `C_Yβ` of the side force with respect to the sideslip angle.
    pub cy_beta: f64,
    /// Derivative `C_Yδ` of the side force with respect to the rudder angle.
    pub cy_rudder: f64,
    /// Derivative `C_lβ` of the rolling moment with respect to the sideslip angle.
    pub cl_beta: f64,
    /// Derivative `C_lp` of the rolling moment with respect to the roll rate.
    pub cl_p: f64,
    /// Derivative `C_lr` of the rolling moment with respect to the yaw rate.
    pub cl_r: f64,
    /// Derivative `C_lδ` of the rolling moment with respect to the aileron angle.
    pub cl_aileron: f64,
    /// Derivative `C_lδ` of the rolling moment with respect to the rudder angle.
    pub cl_rudder: f64,
    /// Derivative `C_nβ` of the yawing moment with respect to the sideslip angle.
    pub cn_beta: f64,
    /// Derivative `C_np` of the yawing moment with respect to the roll rate.
    pub cn_p: f64,
    /// Derivative `C_nr` of the yawing moment with respect to the yaw rate.
    pub cn_r: f64,
    /// Derivative `C_nδ` of the yawing moment with respect to the aileron angle.
    pub cn_aileron: f64,
    /// Derivative `C_nδ` of the yawing moment with respect to the rudder angle.
    pub cn_rudder: f64,

    elevator: Input,
    aileron: Input,
    rudder: Input,
    #[body(mass = mass, inertia = [[ixx, 0, -product], [0, iyy, 0], [-product, 0, izz]])]
    airframe: Body,
    #[joint(ground -> airframe)]
    flight: Free,

    #[define(v(airframe / ground / ground))]
    velocity: Vector,
    #[define(norm(velocity))]
    speed: Scalar,
    #[define(angle_of_attack(airframe, velocity))]
    alpha: Scalar,
    #[define(sideslip(airframe, velocity))]
    beta: Scalar,
    #[define(speed / cruise - 1)]
    faster: Scalar,
    #[define(density / 2 * speed * speed * area)]
    load: Scalar,
    #[define(omega(airframe / ground))]
    turning: Vector,
    #[define(span / (2 * speed) * dot(turning, airframe.x))]
    rolling: Scalar,
    #[define(chord / (2 * speed) * dot(turning, airframe.y))]
    pitching: Scalar,
    #[define(span / (2 * speed) * dot(turning, airframe.z))]
    yawing: Scalar,
    #[define(chord / (2 * speed) * rate(alpha))]
    plunging: Scalar,

    #[define(cx_u * faster + cx_alpha * alpha + cx_elevator * elevator)]
    cx: Scalar,
    #[define(cy_beta * beta + cy_rudder * rudder)]
    cy: Scalar,
    #[define(-mass * g / (density / 2 * cruise * cruise * area))]
    cz_0: Scalar,
    #[define(
        cz_0 + cz_u * faster + cz_alpha * alpha + cz_q * pitching + cz_alpha_rate * plunging + cz_elevator * elevator
    )]
    cz: Scalar,
    #[define(cl_beta * beta + cl_p * rolling + cl_r * yawing + cl_aileron * aileron + cl_rudder * rudder)]
    cl: Scalar,
    #[define(
        cm_u * faster + cm_alpha * alpha + cm_q * pitching + cm_alpha_rate * plunging + cm_elevator * elevator
    )]
    cm: Scalar,
    #[define(cn_beta * beta + cn_p * rolling + cn_r * yawing + cn_aileron * aileron + cn_rudder * rudder)]
    cn: Scalar,

    #[acts(on = airframe, value = load * (cx * airframe.x + cy * airframe.y + cz * airframe.z))]
    aerodynamic_force: Force,
    #[acts(
        on = airframe,
        value = load * (span * cl * airframe.x + chord * cm * airframe.y + span * cn * airframe.z)
    )]
    aerodynamic_moment: Torque,
    #[acts(on = airframe, along = airframe.x)]
    thrust: Force,

    #[output(alpha)]
    angle_of_attack: Scalar,
    #[output(speed)]
    airspeed: Scalar,
    #[output(flight_path(velocity))]
    climb: Scalar,
    #[output(dot(a(airframe / ground / ground) - g * ground.z, airframe.z))]
    felt: Scalar,
}

impl CruisingAircraft {
    /// Boeing 747-100 at Mach 0.8 in 40 000 ft (Etkin and Reid, tables 6.1 and 6.6 and ch. 7).
    pub const BOEING_747: Self = Self {
        g: 9.81,
        mass: 2.83176e6 / 9.81,
        ixx: 0.247e8,
        iyy: 0.449e8,
        izz: 0.673e8,
        product: -0.212e7,
        density: 0.3045,
        cruise: 235.9,
        area: 511.0,
        chord: 8.324,
        span: 59.64,
        cx_u: -0.1080,
        cx_alpha: 0.2193,
        cx_elevator: -3.818e-6,
        cz_u: -0.1060,
        cz_alpha: -4.920,
        cz_q: -5.921,
        cz_alpha_rate: 5.896,
        cz_elevator: -0.3648,
        cm_u: 0.1043,
        cm_alpha: -1.023,
        cm_q: -23.92,
        cm_alpha_rate: -6.314,
        cm_elevator: -1.444,
        cy_beta: -0.8771,
        cy_rudder: 0.1146,
        cl_beta: -0.2797,
        cl_p: -0.3295,
        cl_r: 0.3040,
        cl_aileron: -1.368e-2,
        cl_rudder: 6.976e-3,
        cn_beta: 0.1946,
        cn_p: -0.04073,
        cn_r: -0.2737,
        cn_aileron: -1.973e-4,
        cn_rudder: -0.1257,
    };

    /// Navion, a light aircraft with four seats, at 176 ft/s at sea level: 2750 lb, 184 ft², with
    /// `C_L = 0.41`, `C_D = 0.05`, `C_Lα = 4.44`, `C_Dα = 0.33`. Forces due to the pitch rate are neglected,
    /// as in Nelson.
    pub const NAVION: Self = Self {
        g: 32.2 * FOOT,
        mass: 2750.0 / 32.2 * SLUG,
        ixx: 1048.0 * SLUG * FOOT * FOOT,
        iyy: 3000.0 * SLUG * FOOT * FOOT,
        izz: 3530.0 * SLUG * FOOT * FOOT,
        product: 0.0,
        density: 0.002378 * SLUG / (FOOT * FOOT * FOOT),
        cruise: 176.0 * FOOT,
        area: 184.0 * FOOT * FOOT,
        chord: 5.7 * FOOT,
        span: 33.4 * FOOT,
        cx_u: -0.10,
        cx_alpha: 0.41 - 0.33,
        cx_elevator: 0.0,
        cz_u: 0.0,
        cz_alpha: -(4.44 + 0.05),
        cz_q: 0.0,
        cz_alpha_rate: 0.0,
        cz_elevator: -0.355,
        cm_u: 0.0,
        cm_alpha: -0.683,
        cm_q: -9.96,
        cm_alpha_rate: -4.36,
        cm_elevator: -0.923,
        cy_beta: -0.564,
        cy_rudder: 0.157,
        cl_beta: -0.074,
        cl_p: -0.410,
        cl_r: 0.107,
        cl_aileron: 0.1342,
        cl_rudder: 0.107,
        cn_beta: 0.071,
        cn_p: -0.0575,
        cn_r: -0.125,
        cn_aileron: -0.00346,
        cn_rudder: -0.072,
    };
}

/// Length of a foot, m.
const FOOT: f64 = 0.3048;

/// Mass of a slug, kg.
const SLUG: f64 = 14.593_902_937_206_36;

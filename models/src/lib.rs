//! Ready-made mechanisms for Linkwork, from the textbook's first page to humanoid robots.
//!
//! Each mechanism has its own file, which states the problem, its source, its parameters and, if one exists,
//! the closed form of its motion. A test of the same name in `tests/gallery` compares the generated equations
//! with that closed form.
//!
//! ```
//! use linkwork::prelude::*;
//! use linkwork_models::Pendulum;
//!
//! # fn main() -> Result<(), Error> {
//! let pendulum = Pendulum { g: 9.81, mass: 1.0, length: 0.5 };
//! let end = simulate(&pendulum).from([0.3], [0.0]).duration(2.0).finish()?;
//! println!("after two seconds: {:.4} rad", end.q[0]);
//! # Ok(())
//! # }
//! ```
//!
//! The examples of this package are the next step: `cargo run --release --example tour -p linkwork-models`.
//!
//! # By class
//!
//! The first seven classes are those of Bernstein, Goel and Ansari, *Geometry, Kinematics, Statics, and
//! Dynamics*. The column *freedom* counts the degrees of freedom: independent velocities.
//!
//! | pendulums | freedom | closed form in the test |
//! | --- | --- | --- |
//! | [`Pendulum`] | 1 | period by an elliptic integral |
//! | [`DoublePendulum`] (rods, relative angles) | 2 | mass matrix and bias forces |
//! | [`CoplanarDoublePendulum`] (particles, absolute angles) | 2 | Lagrangian, normal modes |
//! | [`TriplePendulum`], [`QuintuplePendulum`] | 3, 5 | mass matrix and bias forces in absolute angles |
//! | [`SphericalPendulum`] | 2 | conical motion |
//! | [`ElasticPendulum`] | 2 | radial oscillations, small swings |
//! | [`KapitzaPendulum`] (vibrating pivot) | 1 | stable upright position, slow frequency |
//! | [`FoucaultPendulum`] (on the rotating earth) | 2 | rotation of the plane as a function of the latitude; exact at the pole |
//! | [`CartPole`] | 2 | mass matrix and bias forces |
//! | [`FurutaPendulum`] (rotary) | 2 | mass matrix and bias forces, small swings |
//! | [`RodInSlot`] | 2 | vertical fall of the centre of mass |
//! | [`PendulumOnCollar`] (governor) | 3 | mass matrix, steady rotation, conserved momentum |
//! | [`WilberforcePendulum`] | 2 | beats between translation and rotation |
//!
//! | mass, dashpot (`c`) and spring (`k`) systems | freedom | closed form in the test |
//! | --- | --- | --- |
//! | [`SpringChain`] | 3 | natural frequencies, modal damping |
//! | [`TunedSuspension`] (with inerter) | 2 | mass and stiffness matrix, the excited cart at rest |
//! | [`DuffingOscillator`] | 1 | period by an elliptic integral, two wells |
//! | [`CarAxle`] (on a bumpy road) | 2 | published motion |
//!
//! | gimbals | freedom | closed form in the test |
//! | --- | --- | --- |
//! | [`Gyroscope`] | 3 | steady precession |
//! | [`RateGyroscope`] (on a rotating base) | 2 | equations of motion, deflection as a function of the rate |
//!
//! | shafts | freedom | closed form in the test |
//! | --- | --- | --- |
//! | [`ShaftWithSlider`] | 2 | `r = r₀ cosh ωt`, conserved momentum |
//! | [`JeffcottRotor`] (unbalanced) | 2 | steady whirl below and above the critical speed |
//! | [`BrakedFlywheel`] (dry friction) | 1 | running down |
//! | [`NutOnScrew`] | 1 | constant acceleration |
//!
//! | linkages | freedom | closed form in the test |
//! | --- | --- | --- |
//! | [`FourBar`] | 1 | Freudenstein's equation, ratios of the rates, holding torque |
//! | [`SliderCrank`] | 1 | position of the piston, reduced inertia |
//! | [`FiveBar`] (parallel robot) | 2 | intersection of circles, statics, reduced inertia |
//! | [`StewartPlatform`] | 6 | inverse kinematics, forces by virtual work |
//! | [`TwoWindows`] (through singular configurations) | 1 | motion of a pendulum |
//! | [`BricardLinkage`] (mobile in spite of Grübler's count) | 1 | relation of the angles, one redundant condition |
//! | [`AndrewsSqueezer`] | 1 | published accelerations and motion |
//! | [`GearPair`] | 1 | reduced inertia, force between the teeth |
//! | [`RemotelyDrivenArm`] (geared, absolute angles) | 2 | mass matrix and bias forces |
//! | [`Ur5`] | 6 | Denavit–Hartenberg parameters |
//! | [`Panda`], [`PandaArm`], [`LoadedPanda`] | 8, 7, 7 | Denavit–Hartenberg parameters |
//! | [`Solo12`], [`AnymalB`] | 18 | free fall, leg kinematics |
//! | [`SimpleHumanoid`] | 35 | free fall |
//!
//! | rolling bodies and skates | freedom | closed form in the test |
//! | --- | --- | --- |
//! | [`DiskOnIncline`] | 1 | accelerations of hoop, disk, shell and ball; no slip |
//! | [`CylinderInTrough`] | 1 | period by an elliptic integral |
//! | [`RollerOnIncline`] (with contact forces) | 1 | accelerations, contact forces |
//! | [`BallInBowl`] | 3 | swings by an elliptic integral, level circles |
//! | [`BallInDish`] (a parametric surface) | 3 | accelerations, level circles with spin, constant energy |
//! | [`BallInFunnel`] | 3 | level circles with spin, two integrals of the motion |
//! | [`BallInTube`] | 3 | vertical oscillation with `√(2/7)` of the rate around the axis |
//! | [`BallOnTurntable`] (driven) | 3 | circles at 2/7 of the table's rate |
//! | [`BowlingBall`] (slides with friction) | 5 | accelerations, start and speed of rolling, parabola |
//! | [`SlidingRod`] (Painlevé's) | 2 | accelerations, normal force, jamming by friction |
//! | [`RollingCone`] | 1 | energies, swings by an elliptic integral, point of action of the normal force |
//! | [`RollingDisk`] | 3 | accelerations, critical speed, circles |
//! | [`Rattleback`] | 3 | reversal of the rotation, constant energy |
//! | [`ChaplyginSleigh`] | 2 | speed as a hyperbolic tangent |
//! | [`Bicycle`] (Whipple's, the benchmark) | 3 | published matrices, eigenvalues, weave and capsize speeds |
//!
//! | spinning tops | freedom | closed form in the test |
//! | --- | --- | --- |
//! | [`HeavyTop`] | 3 | Euler's equations, slow and fast steady precession |
//! | [`FreeRigidBody`] (Dzhanibekov) | 6 | period by an elliptic integral |
//!
//! | particles and flight | freedom | closed form in the test |
//! | --- | --- | --- |
//! | [`BeadOnSpinningHoop`] | 1 | tilted equilibrium, Jacobi's integral |
//! | [`ChargedParticle`] (crossed fields) | 3 | cycloid |
//! | [`TwoBodies`] (Kepler) | 6 | ellipse, Laplace's vector |
//! | [`GravityGradientSatellite`] | 6 | torque, pitch oscillation |
//! | [`Aircraft`] | 6 | trim in level flight, level turn |
//! | [`CruisingAircraft`] (a transport and a light aircraft given by their derivatives) | 6 | published matrices and modes |
//! | [`Fighter`] (tables, an engine with a lag) | 6 and 1 state | published rates, trims and matrices |
//! | [`Glider`] | 6 | flattest glide and slowest sink, phugoid, stability of the spiral |
//! | [`HypersonicGlider`] (over the round rotating Earth) | 6 | lift to the east and west, Coriolis, ground track |
//! | [`PlanarRotorcraft`] | 3 | hovering, free fall |
//! | [`Quadrotor`] (rotors with a lag) | 6 and 4 states | hovering, transfer functions |
//! | [`WheeledSatellite`] (reaction wheels) | 6 | rotation by its wheels, nutation |
//!
//! | drives | freedom | closed form in the test |
//! | --- | --- | --- |
//! | [`DcMotor`] (inductance, back-EMF) | 1 and 1 state | currents, speeds, eigenvalues, energy |
//! | [`GearedJoint`] (backlash, losses) | 2 | accelerations, efficiencies, period of oscillations |
//! | [`SeriesElasticJoint`] | 2 | accelerations, transfer function of the torque |
//! | [`DelayedServo`] (PID) | 1 and 4 states | characteristic polynomial, phase of the delay |
//! | [`MuscleForearm`] (Hill-type) | 1 and 2 states | activation over time, force and speed |
//!
//! # By joint
//!
//! | joint | freedom | element of the language | example |
//! | --- | --- | --- | --- |
//! | pin, hinge | 1 | `Pin` | [`Pendulum`], [`BrakedFlywheel`] |
//! | dual pin | 2 | `Pin`, then `Pin` | parallel: [`DoublePendulum`]; perpendicular: [`FurutaPendulum`] |
//! | universal | 2 | `Universal` | [`SphericalPendulum`], [`StewartPlatform`] |
//! | ball | 3 | `Ball` | [`HeavyTop`], [`StewartPlatform`] |
//! | sleeve | 1 | `Sleeve` | [`CartPole`], [`DuffingOscillator`] |
//! | dual sleeve, x–y stage | 2 | `Stage` | [`JeffcottRotor`] |
//! | dual sleeve-pin | 3 | `Planar` | [`PlanarRotorcraft`] |
//! | x–y–z stage | 3 | `Stage` | [`ChargedParticle`], [`TwoBodies`] |
//! | slot | 2 | `Slot` | [`RodInSlot`] |
//! | collar | 2 | `Collar` | [`WilberforcePendulum`] |
//! | collar-pin | 3 | `Collar`, then `Pin` | [`PendulumOnCollar`] |
//! | screw | 1 | `Screw` | [`NutOnScrew`] |
//! | none | 6 | `Free` | [`FreeRigidBody`], [`Aircraft`], [`Solo12`] |
//!
//! # By element
//!
//! | element | example |
//! | --- | --- |
//! | a free `Coordinate` | [`ElasticPendulum`], [`CoplanarDoublePendulum`], [`CylinderInTrough`] |
//! | motion prescribed as a function of time (`t`) | [`BeadOnSpinningHoop`], [`KapitzaPendulum`], [`JeffcottRotor`] |
//! | springs and dashpots between bodies | [`SpringChain`], [`TunedSuspension`] |
//! | a spring with a force law | [`DuffingOscillator`] |
//! | inerter | [`TunedSuspension`] |
//! | dry friction | [`BrakedFlywheel`] |
//! | central gravity | [`TwoBodies`], [`GravityGradientSatellite`] |
//! | forces and torques with a value | [`Aircraft`], [`ChargedParticle`], [`DuffingOscillator`] |
//! | a user-defined potential energy (`Potential`) | [`WilberforcePendulum`], [`FoucaultPendulum`], [`ElasticPendulum`] |
//! | definitions, outputs | [`Aircraft`], [`RemotelyDrivenArm`], [`Gyroscope`] |
//! | joints that close loops | [`FourBar`], [`StewartPlatform`] |
//! | conditions on coordinates (`Holonomic`) | [`CarAxle`], [`GearPair`] |
//! | gears | [`RemotelyDrivenArm`], [`GearPair`] |
//! | conditions on velocities (`Nonholonomic`) | [`ChaplyginSleigh`] |
//! | rolling pairs (`Rolling`) | [`RollingDisk`], [`BallInBowl`], [`Bicycle`] |
//! | slipping pairs with friction (`Slipping`) | [`BowlingBall`], [`SlidingRod`] |
//! | a base whose motion is prescribed (`massive`) | [`RateGyroscope`], [`BallOnTurntable`] |
//! | a robot from a file, with additional elements | [`Ur5`], [`LoadedPanda`] |
//!
//! # The book, section by section
//!
//! Topics of Bernstein, Goel and Ansari that concern a mechanism, in the order of the chapters: mechanisms
//! and their classes (1), geometry (2), tensors (3), kinematics (4), frames (5), statics (6), Newton's and
//! Euler's dynamics (7), energy (8), Lagrange's, Hamilton's, Gibbs's, Appell's and Kane's equations (9);
//! aircraft, linearisation, flight modes, linear systems and frequency response (10–16). The last column
//! names a mechanism, or a test by its file in `tests` (of `linkwork-design` where indicated) and its
//! function.
//!
//! | chapter | topic | words | example and test |
//! | --- | --- | --- | --- |
//! | 1 | classes of mechanisms: pendulums, springs and masses, gimbals, shafts, linkages, rolling bodies, tops | the gallery | the tables above, a test each: [`Pendulum`], [`SpringChain`], [`Gyroscope`], [`ShaftWithSlider`], [`FourBar`], [`RollingDisk`], [`HeavyTop`] |
//! | 1 | joints and their degrees of freedom | `Pin`, `Sleeve`, `Screw`, `Collar`, `Slot`, `Universal`, `Ball`, `Planar`, `Stage`, `Free`, `Weld` | the table by joint above; `invariants`: `joints.rs` |
//! | 1 | conservative, dissipative, control and disturbance forces | `dissipated_power`, `control_power`, `disturbance_power`, `power(element)` | `power_balance_holds_along_motion`; `measurements.rs`: `element_powers_equal_energy_rates` |
//! | 2 | points, relative positions, frames with and without an origin | `Point`, `Frame`, `r(y / x)`, `body.at(vector)` | `textbook/orientations.rs`: `vector_functions_have_their_documented_values`; [`Gyroscope`] |
//! | 2 | physical vectors, `dot`, `cross`, angles, projections | expressions | `textbook/orientations.rs`: `vector_functions_have_their_documented_values` |
//! | 2 | orientation: Euler angles, eigenaxis, quaternions, Gibbs and Rodrigues vectors, their rates | `linkwork::rotation`, `rotated(…)`, `#[frame(…)]` | [`HeavyTop`] in two charts: `heavy_top_agrees_in_two_coordinate_charts` |
//! | 2 | physical matrices: projectors, rotation and cross-product matrices, their products and transposes, resolved in any frame | `Matrix`: `projector`, `rotation`, `skew`, `outer`, `transpose`, `trace` | `textbook/matrices.rs`: `matrix_expressions_equal_vector_expressions` |
//! | 2 | resolving in a frame, orientation matrices | `resolved_in = frame`, `rotation(B / A)`, `linkwork::rotation` | `textbook/matrices.rs`: `matrix_expressions_equal_vector_expressions` |
//! | 2 | nonstandard and reciprocal frames | `linkwork::rotation::reciprocal`, and components along any three vectors as expressions, `dot(v, cross(f2, f3)) / dot(f1, cross(f2, f3))`; frames that carry bodies are orthonormal, because the orientation of a rigid body is a rotation | `textbook/matrices.rs`: `oblique_components_follow_from_reciprocal_vectors`, `outputs_may_have_oblique_components` |
//! | 2 | gradients of scalar fields | `gradient(field / point)` | `textbook/curves.rs`: `force_of_a_field_is_its_gradient` |
//! | 3 | tensors of second order as matrices, dyads, transformation of components between frames | `Matrix`, `outer(a, b)`, `resolved_in` | `textbook/matrices.rs`: `matrix_expressions_equal_vector_expressions` |
//! | 3 | Kronecker products, vectorised matrices, wedge products | nalgebra's `kronecker`; `vectorized`, `wedge` of `linkwork::rotation` | `textbook/matrices.rs`: `kronecker_products_solve_sylvesters_equation` |
//! | 3 | tensors of higher order and their coordinates | left out: no equation of a mechanism's user contains one | |
//! | 4 | position, velocity, acceleration, angular velocity and acceleration with respect to a frame | `r`, `v`, `a`, `omega`, `alpha` with slashes | [`RateGyroscope`]; `accelerations.rs` |
//! | 4 | rates of vectors and matrices as seen from a frame: the transport theorem, Poisson's equation | `rate(vector / frame)`, `rate(matrix / frame)` | `textbook/motions.rs`: `eulers_laws_hold_for_a_set_of_bodies`; `matrix_expressions_equal_vector_expressions` |
//! | 4 | instantaneous centres of velocity and acceleration | `instant_center`, `acceleration_center` | `textbook/motions.rs`: `ladder_rotates_about_its_instantaneous_centre`, `wheel_rotates_about_its_contact_point` |
//! | 4 | screw of a motion (Chasles, Mozzi) | `screw_axis`, `screw_pitch` | `textbook/motions.rs`: `two_rotations_form_a_screw_of_the_cylindroid`, `nut_motion_has_the_screw_axis_and_pitch_of_its_thread` |
//! | 4 | closed loops, rolling, sliding | `Pin` and others that close loops, `Rolling`, `Slipping` | [`FourBar`], [`RollingDisk`], [`BowlingBall`] |
//! | 4 | rolling as a condition on the velocity of the lowest point | `wheel.at(-radius * fork.z)` in a `Nonholonomic` | `wheel_rolls_on_a_point_in_fork_axes` |
//! | 5 | cylindrical and spherical coordinates and their frames | `#[frame(ground, cylindrical(r(point / ground)))]`, `spherical`; a chain of joints or `Coordinate`s | `spherical_and_cylindrical_accelerations_have_textbook_terms`; [`SphericalPendulum`]; `spherical_pendulum_agrees_in_two_coordinate_charts` |
//! | 5 | frames along curves (Frenet and Serret), curvature, torsion | `#[frame(ground, frenet(curve, s))]`, `curvature(curve, s)`, `torsion(curve, s)` | `textbook/curves.rs`: `helix_has_constant_curvature_and_torsion`, `curvature_of_cubics_and_ellipses_has_closed_forms` |
//! | 5 | coordinates along a curve | `Coordinate`, `at = expression` | `beads_on_wires_have_closed_forms` |
//! | 6 | reactions of joints, equilibrium of each free body | `reaction_force`, `reaction_torque` | `constraints/reactions.rs`: `reactions_balance_every_free_body` |
//! | 6 | free-body diagrams: all forces on a body, in any frame, as data and as a drawing | `#[output(body)] loads: FreeBody`, `linkwork_view::free_body` | `free_body_diagrams/main.rs`: `free_body_forces_equal_momentum_rates` |
//! | 6 | forces along lines, ropes over pegs, cables around drums | `between = (a, b)`, `on = expression`, `cable(a / b, drum.cylinder(radius, axis))` | `textbook/curves.rs`: `elements_act_on_any_length_expression`, `cables_wrap_along_the_shortest_path`, `cable_lengths_have_exact_derivatives` |
//! | 6 | equilibria with fixed coordinates, unknown inputs and parameters; buckling | `linkwork_design::steady` | `steady` of that crate: a chain's catenary, a column, a table, a platform |
//! | 6 | a chain's catenary, an unstable column, three legs, a platform on six | `linkwork_design::steady` | `chain_hangs_in_catenary`, `column_buckles_at_critical_load`, `table_legs_share_the_load`, `six_legs_support_a_platform` of design |
//! | 6 | stability by energy and by eigenvalues | `stiffness`, `linear_system` of an equilibrium | `bead_on_hoop_has_four_equilibria` |
//! | 6 | no equilibrium, too few or too many unknowns, unknown names | errors of `linkwork_design::Error` that report them | `steady_state_errors_name_the_variable` of design |
//! | 7 | Newton's and Euler's equations | `inverse_dynamics`, `forward_dynamics` | [`FreeRigidBody`], every mechanism |
//! | 7 | inertia of solids, parallel axes, rotated inertias; physically consistent principal moments | `inertia = …`, `validate()` | `validate.rs` |
//! | 7 | inertia about any point, of one body or several, in any frame | `inertia(body / point)`, `moment_of_inertia(body / point, x, y)`, `about = point` of a `Body` | `moments_of_inertia_agree_with_kinetic_energies`, `inertia_about_another_point_is_moved_to_the_centre_of_mass`, `matrix_expressions_equal_vector_expressions` |
//! | 7 | momentum and angular momentum of bodies, about any point | `momentum`, `angular_momentum`, the function `momentum` | `measurements.rs`: `body_momenta_and_energies_add_up` |
//! | 7 | momenta of a set of bodies, external forces and torques | `momentum((first, second))`, `angular_momentum((first, second) / point)`, `center_of_mass((first, second) / point)` | `eulers_laws_hold_for_a_set_of_bodies` |
//! | 7 | centre of percussion | `center_of_percussion(body / point, axis)` | `impulse_at_the_centre_of_percussion_leaves_the_grip_at_rest` |
//! | 7 | springs, dashpots, inerters, friction, central gravity | force elements | `textbook/elements.rs`, `textbook/gravity.rs` |
//! | 7 | steady motions: precession, governor, circles of disk and bicycle, climbing and turning flight | `Trim` of an equilibrium | `tests/steady.rs` here, [`HeavyTop`], [`Aircraft`] |
//! | 8 | kinetic and potential energy; conservative, dissipative, control and disturbance power | functions of every mechanism, `kinetic_energy(body)` | `textbook/elements.rs`: `power_balance_holds_along_motion` |
//! | 8 | work and power of one force | `power(element)`, `#[state(rate = power(motor))] work: State` | `work_state_integrates_the_power_of_a_force`, `element_powers_equal_energy_rates` |
//! | 8 | conserved quantities: energy, Jacobi's integral, cyclic coordinates, momenta | the option `conserved` | `conserved.rs` |
//! | 9 | Lagrange's equations, with multipliers | `EQUATIONS`, `equations = lagrange` | [`DoublePendulum`]; `derivations.rs` |
//! | 9 | Hamilton's equations | the option `hamilton`, `equations = hamilton` | `conserved.rs`: `hamiltons_equations_agree_with_the_dynamics` |
//! | 9 | Kane's equations in independent speeds | `formulation = speeds` | `constraints/formulations.rs` |
//! | 9 | printed equations of Gibbs, Appell and Kane | `EQUATIONS` of mechanisms with a `Speed` | `rolling_disk_moves_equally_in_kanes_speeds` |
//! | 9 | Kane's equations without multipliers, nonholonomic constraints | `equations = kane` | [`ChaplyginSleigh`]; `printed_kane_equations_equal_the_dynamics` |
//! | 9 | Routh's reduction over cyclic coordinates | the option `routh`, `equations = routh` | `lagranges_equations_hold_for_the_routhian`, `printed_routhian_equals_generated_functions` of the compiler |
//! | 9 | user-defined generalized speeds | `#[speed(expression)] wx: Speed` | `integrators_in_speeds_have_their_orders`, `frame_velocities_are_equal_in_speeds` |
//! | 10–16 | printed linear equations in the user's parameters, characteristic polynomial, Routh's conditions | `#[equilibrium(theta = 0)] upright: Equilibrium` | `pendulum_linearises_to_its_natural_frequency`, `linear_equations_are_derivatives_of_the_dynamics` of the compiler |
//! | 10–16 | linearisation for small motions | `linearize`, `linear_system` | [`Bicycle`]; `linearization.rs` |
//! | 10–16 | aircraft: axes of body, stability and wind; angles of attack, sideslip, heading, flight path, bank | `angle_of_attack(body, velocity)`, `sideslip`, `heading(body)`, …, `#[frame(…)]` | [`Aircraft`]; `tables.rs` |
//! | 10–16 | coefficients of aircraft from tables, the standard atmosphere | `Table<N>`, `density(height)`, … | [`Fighter`]; `tables.rs` |
//! | 10–16 | engine and actuator lags | `#[state(rate = …)] power: State`, `extended` | [`Fighter`], [`Quadrotor`]; `first_order.rs`; `trim_solves_for_first_order_states` in `flight` of design |
//! | 10–16 | trim | `linkwork_design::steady` | [`Aircraft`]; [`Fighter`]: `trimmed_flight_matches_the_book`; `tests/steady.rs` here and in design |
//! | 10–16 | gliding, hovering, rotation by wheels | `value = …` of forces, `#[state(rate = …)]`, a `Pin` for each wheel | [`Glider`], [`Quadrotor`], [`WheeledSatellite`] |
//! | 10–16 | six degrees of freedom over the round rotating Earth | a `Free` joint on a body whose motion is prescribed | [`HypersonicGlider`] |
//! | 10–16 | forces linear in accelerations (derivatives with respect to `α̇`, added mass) | `value = …` with `rate(alpha)`, `a(body / ground / ground)` | [`CruisingAircraft`]; `acceleration_forces.rs`; `accelerations` of design |
//! | 10–16 | dimensional and dimensionless stability and control derivatives, static margin | `linkwork_design::flight::Derivatives` | [`CruisingAircraft`]: `dimensionless_derivatives_match_declared` |
//! | 10–16 | flight modes: phugoid, short period, Dutch roll, roll, spiral | `linkwork_design::flight::FlightModes` | [`CruisingAircraft`]: `transport_matches_etkin_and_reid_modes`, `navion_matches_nelson_modes`; `phugoid_matches_lanchester` in `flight`, `jet_transport_modes_match_published` in `anchors` of design |
//! | 10–16 | modes from published derivatives and matrices: an airliner, an attack aircraft, a fighter | `linkwork_design::flight::FlightModes` | `dc8_matches_cook_modes`, `printed_matrices_yield_named_modes`, `centre_of_mass_determines_pitch_modes` |
//! | 10–16 | satellites: nutation, wheels that stabilise a spin about the intermediate axis | a `Pin` for each wheel, `linear_system` | [`WheeledSatellite`]; `wheel_stabilises_intermediate_axis` |
//! | 10–16 | linear systems: poles, zeros, transfer functions, responses | `linkwork_design::StateSpace`, `TransferFunction` | `jet_transport_channels_match_published` and `step_responses_match_published` in `anchors` of design |
//! | 10–16 | gyroscopic and circulatory forces: nutation, whirl, gravity gradient | `linear_system`, `second_order_form` | `gyroscope_nutation_has_textbook_frequency`, `internally_damped_rotor_has_genta_poles`, `gravity_gradient_stabilises_satellite` in `flight` of design |
//! | 10–16 | mass, damping, gyroscopic, stiffness and circulatory matrices under constraints | `Trim::second_order_form` | [`Bicycle`]: `bicycle_has_published_matrices`; `constrained_forms` of design |
//! | 10–16 | linearised motions with stabilised constraints | `constraint::stabilized`, `linear_system` | `stabilised_constraints_add_decay_poles` in `flight` of design |
//! | 10–16 | eigenvalues of a bicycle | `Trim::linear_system` | `bicycle_has_published_eigenvalues` in `tests/steady.rs` here |
//! | 10–16 | responses over time by the matrix exponential, repeated eigenvalues | `step_response`, `forced_response`, `matrices::exponential` | `linear_inputs_are_exact`, `repeated_poles_have_exact_results` |
//! | 10–16 | invariant zeros, minimal realisations, controllability, observability | `zeros`, `minimal`, `kalman_ranks` | `system_matrix_loses_rank_at_zeros`, `realisations_are_minimal` |
//! | 10–16 | Lyapunov's and Riccati's equations, regulators, estimators, placed poles | `matrices::lyapunov`, `lqr`, `kalman`, `place` | `matrix_equations_have_small_residuals`, `regulators_are_optimal`, `riccati_solutions_match_benchmarks`, `placed_poles_are_the_required_ones` |
//! | 10–16 | digital control: discrete-time systems | `discretize`, `lqr_held` | `discretisation_is_inverted`, `discrete_riccati_benchmarks_match_exact_solutions` |
//! | 10–16 | block diagrams | `series`, `parallel`, `feedback` | `connections_multiply_and_add_responses` in `properties` of design |
//! | 10–16 | errors: unstable, uncontrollable and improper systems | `linkwork_design::Error` | `bad_input` of design |
//! | 10–16 | Routh's table, margins, root locus | `Polynomial`, `margins`, `root_locus` | `margins_and_routh_table_match_published`, `routh_tables_match_ogata` in `anchors` of design; `routh_counts_roots`, `margins_include_every_crossing` |
//! | 10–16 | frequency response, Bode's and Nyquist's diagrams | `frequency_response`, `linkwork_design::picture` | `jet_transport_response_matches_reference` in `anchors`, `pictures` of design |

mod aircraft;
mod andrews_squeezer;
mod arm6;
mod arm7;
mod ball_in_bowl;
mod ball_in_dish;
mod ball_in_funnel;
mod ball_in_tube;
mod ball_on_turntable;
mod bead_on_spinning_hoop;
mod bicycle;
mod bowling_ball;
mod braked_flywheel;
mod bricard_linkage;
mod car_axle;
mod cart_pole;
mod chaplygin_sleigh;
mod charged_particle;
mod coplanar_double_pendulum;
mod cruising_aircraft;
mod cylinder_in_trough;
mod dc_motor;
mod delayed_servo;
mod disk_on_incline;
mod double_pendulum;
mod duffing_oscillator;
mod elastic_pendulum;
mod fighter;
mod five_bar;
mod foucault_pendulum;
mod four_bar;
mod free_rigid_body;
mod furuta_pendulum;
mod gear_pair;
mod geared_joint;
mod glider;
mod gravity_gradient_satellite;
mod gyroscope;
mod heavy_top;
mod humanoid;
mod hypersonic_glider;
mod jeffcott_rotor;
mod kapitza_pendulum;
mod muscle_forearm;
mod nut_on_screw;
mod pendulum;
mod pendulum_chain;
mod pendulum_on_collar;
mod planar_rotorcraft;
mod quadrotor;
mod quadruped;
mod rate_gyroscope;
mod rattleback;
mod remotely_driven_arm;
mod rod_in_slot;
mod roller_on_incline;
mod rolling_cone;
mod rolling_disk;
mod series_elastic_joint;
mod shaft_with_slider;
mod slider_crank;
mod sliding_rod;
mod spherical_pendulum;
mod spring_chain;
mod stewart_platform;
mod tuned_suspension;
mod two_bodies;
mod wheeled_satellite;
mod wilberforce_pendulum;
mod windows;

pub use aircraft::Aircraft;
pub use andrews_squeezer::AndrewsSqueezer;
pub use arm6::Ur5;
pub use arm7::{LoadedPanda, Panda, PandaArm};
pub use ball_in_bowl::BallInBowl;
pub use ball_in_dish::BallInDish;
pub use ball_in_funnel::BallInFunnel;
pub use ball_in_tube::BallInTube;
pub use ball_on_turntable::BallOnTurntable;
pub use bead_on_spinning_hoop::BeadOnSpinningHoop;
pub use bicycle::Bicycle;
pub use bowling_ball::BowlingBall;
pub use braked_flywheel::BrakedFlywheel;
pub use bricard_linkage::BricardLinkage;
pub use car_axle::CarAxle;
pub use cart_pole::CartPole;
pub use chaplygin_sleigh::ChaplyginSleigh;
pub use charged_particle::ChargedParticle;
pub use coplanar_double_pendulum::CoplanarDoublePendulum;
pub use cruising_aircraft::CruisingAircraft;
pub use cylinder_in_trough::CylinderInTrough;
pub use dc_motor::DcMotor;
pub use delayed_servo::DelayedServo;
pub use disk_on_incline::DiskOnIncline;
pub use double_pendulum::DoublePendulum;
pub use duffing_oscillator::DuffingOscillator;
pub use elastic_pendulum::ElasticPendulum;
pub use fighter::Fighter;
pub use five_bar::FiveBar;
pub use foucault_pendulum::FoucaultPendulum;
pub use four_bar::FourBar;
pub use free_rigid_body::FreeRigidBody;
pub use furuta_pendulum::FurutaPendulum;
pub use gear_pair::GearPair;
pub use geared_joint::GearedJoint;
pub use glider::Glider;
pub use gravity_gradient_satellite::GravityGradientSatellite;
pub use gyroscope::Gyroscope;
pub use heavy_top::HeavyTop;
pub use humanoid::SimpleHumanoid;
pub use hypersonic_glider::HypersonicGlider;
pub use jeffcott_rotor::JeffcottRotor;
pub use kapitza_pendulum::KapitzaPendulum;
pub use muscle_forearm::MuscleForearm;
pub use nut_on_screw::NutOnScrew;
pub use pendulum::Pendulum;
pub use pendulum_chain::{QuintuplePendulum, TriplePendulum};
pub use pendulum_on_collar::PendulumOnCollar;
pub use planar_rotorcraft::PlanarRotorcraft;
pub use quadrotor::Quadrotor;
pub use quadruped::{AnymalB, Solo12};
pub use rate_gyroscope::RateGyroscope;
pub use rattleback::Rattleback;
pub use remotely_driven_arm::RemotelyDrivenArm;
pub use rod_in_slot::RodInSlot;
pub use roller_on_incline::RollerOnIncline;
pub use rolling_cone::RollingCone;
pub use rolling_disk::RollingDisk;
pub use series_elastic_joint::SeriesElasticJoint;
pub use shaft_with_slider::ShaftWithSlider;
pub use slider_crank::SliderCrank;
pub use sliding_rod::SlidingRod;
pub use spherical_pendulum::SphericalPendulum;
pub use spring_chain::SpringChain;
pub use stewart_platform::StewartPlatform;
pub use tuned_suspension::TunedSuspension;
pub use two_bodies::TwoBodies;
pub use wheeled_satellite::WheeledSatellite;
pub use wilberforce_pendulum::WilberforcePendulum;
pub use windows::TwoWindows;

//! Transport aircraft: its trimmed flight, its response to a gust and to the rudder, and its flight modes.

use crate::report::{Picture, Section, Table, UpperBoundCheck, declaration_of_mechanism, format_number};
use linkwork::nalgebra::DVector;
use linkwork::prelude::*;
use linkwork_design::flight::{self, FlightModes, LATERAL, LONGITUDINAL};
use linkwork_design::steady::{SteadyState, equilibrium};
use linkwork_design::{Mode, StateSpace, picture};
use linkwork_models::CruisingAircraft;

const TRANSPORT: CruisingAircraft = CruisingAircraft::BOEING_747;
/// Speed of the head-on gust, m/s.
const GUST: f64 = 5.0;
/// Duration of the simulated flight, more than two phugoid periods, s.
const DURATION: f64 = 240.0;

/// Published eigenvalues of the aircraft's modes (Etkin and Reid, *Dynamics of Flight*, 1996, ch. 6), 1/s.
const PUBLISHED: [(&str, f64, f64); 5] = [
    ("short period", -0.3719, 0.8875),
    ("phugoid", -0.003289, 0.06723),
    ("Dutch roll", -0.033011, 0.94655),
    ("roll", -0.56248, 0.0),
    ("spiral", -0.0072973, 0.0),
];

pub fn run_aircraft_tour() -> Result<Section, Box<dyn std::error::Error>> {
    let trim = equilibrium(&TRANSPORT)
        .moving([TRANSPORT.cruise, 0.0, 0.0, 0.0, 0.0, 0.0].into())
        .coordinates(["flight.wy"])
        .speeds(["flight.vx", "flight.vz"])
        .inputs(["elevator", "thrust"])
        .output("climb", 0.0)
        .output("airspeed", TRANSPORT.cruise)
        .find()?;
    let system = flight::linear_system(&TRANSPORT, &trim.q, &trim.v, &trim.u)?;
    let modes = FlightModes::from_system(&system)?;
    let named = modes.named_modes();
    let rows = named.iter().map(|(name, mode)| mode_table_row(name, mode));
    let table = Table {
        head: vec!["mode", "eigenvalue, 1/s", "published", "period, s", "damping ratio", "half or double, s"],
        rows: rows.collect(),
    };
    let off = PUBLISHED.iter().map(|(name, re, im)| {
        let mode = named.iter().find(|(found, _)| found == name);
        mode.map_or(f64::NAN, |(_, mode)| {
            (mode.exponent.re - re).hypot(mode.exponent.im - im) / re.hypot(*im)
        })
    });
    let off = off.fold(0.0, |most: f64, x| if x.is_nan() { x } else { most.max(x) });

    let along = system.of_states(&LONGITUDINAL)?;
    let (speed, linear, apart) = simulate_gust_response(&trim, &along)?;
    let checks = vec![
        UpperBoundCheck::new("eigenvalues against those of Etkin and Reid, relative", off, 4e-3),
        UpperBoundCheck::new("trim: elevator, rad", trim.u[0].abs(), 1e-9),
        UpperBoundCheck::new(
            "speed after a gust, equations of motion against linear ones, of the gust",
            apart,
            0.1,
        ),
    ];
    let across = system.of_states(&LATERAL)?;
    let grid = across.natural_frequencies(400)?;
    let rudder = across.frequency_response("r", "rudder", &grid)?;
    let pictures = vec![
        Picture {
            title: "Modes: states as phasors, which turn and die away",
            svg: picture::named_modes(&named)?,
        },
        Picture { title: "Yaw rate answers the rudder", svg: picture::bode(&rudder)? },
        Picture::over_time("Speed after a gust from ahead: the phugoid", "change of speed, m/s", |chart| {
            chart.curve("equations of motion", speed).curve("linear about the trim", linear)
        })?,
    ];
    Ok(Section {
        title: "A transport is trimmed, disturbed and taken apart into its modes".into(),
        text: format!(
            "The Boeing 747 at Mach 0.8 in 40 000 ft by its published derivatives, those by the rate of the \
             angle of attack \
             among them. Newton's method finds level flight at {} m/s; generated derivatives give the linear \
                 motion about \
             it, and its modes come by their names.",
            TRANSPORT.cruise
        ),
        declaration: declaration_without_parameters(&declaration_of_mechanism(
            include_str!("../../src/cruising_aircraft.rs"),
            "CruisingAircraft",
        )),
        equations: "",
        tables: vec![table],
        checks,
        scenes: Vec::new(),
        pictures,
    })
}

/// Returns the text of a mechanism's declaration without its parameters.
fn declaration_without_parameters(declaration: &str) -> String {
    let is_parameter = |line: &&str| line.starts_with("    pub ") || line.starts_with("    #[unit");
    declaration.lines().filter(|line| !is_parameter(line)).collect::<Vec<_>>().join("\n")
}

fn mode_table_row(name: &str, mode: &Mode) -> Vec<String> {
    let format_eigenvalue = |re: f64, im: f64| {
        let wave = if im == 0.0 { String::new() } else { format!(" ± {im:.4}i") };
        format!("{re:.5}{wave}").replace('-', "−")
    };
    let published = PUBLISHED.iter().find(|(known, ..)| *known == name);
    let time = mode.time_to_half().or(mode.time_to_double());
    vec![
        name.into(),
        format_eigenvalue(mode.exponent.re, mode.exponent.im),
        published.map_or("–".into(), |(_, re, im)| format_eigenvalue(*re, *im)),
        mode.period().map_or("–".into(), format_number),
        mode.period().map_or("–".into(), |_| format_number(mode.damping_ratio())),
        time.map_or("–".into(), format_number),
    ]
}

type CurvePoints = Vec<(f64, f64)>;

/// Returns the change of airspeed after a gust by the nonlinear and by the linear equations, and their
/// largest difference relative to the gust.
fn simulate_gust_response(
    trim: &SteadyState<7, 6, 4>,
    along: &StateSpace,
) -> Result<(CurvePoints, CurvePoints, f64), Box<dyn std::error::Error>> {
    let (u, mut v) = (trim.u, trim.v);
    v[0] += GUST;
    let run = simulate(&TRANSPORT).from(trim.q, v).inputs(|_, _, _| u).duration(DURATION).sample_every(0.5);
    let samples: Vec<_> = run.collect::<Result<_, _>>()?;
    let speed: CurvePoints =
        samples.iter().map(|s| (s.t, s.v.fixed_rows::<3>(0).norm() - TRANSPORT.cruise)).collect();
    let start =
        DVector::from_fn(along.order(), |k, _| if along.states()[k].name == "u" { GUST } else { 0.0 });
    let times: Vec<f64> = samples.iter().map(|s| s.t).collect();
    let motion = along.initial_response(start.as_slice(), &times)?;
    let linear: CurvePoints = times.into_iter().zip(motion.output("u")?).collect();
    let apart = speed.iter().zip(&linear).map(|(a, b)| (a.1 - b.1).abs()).fold(0.0, f64::max) / GUST;
    Ok((speed, linear, apart))
}

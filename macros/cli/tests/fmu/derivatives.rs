//! Directional and adjoint derivatives against central differences that an importer computes from values.

use super::{FOUR_BAR, Fmu, set_option_arguments};

/// Checks that directional and adjoint derivatives are equal, and equal to central differences.
pub fn check_derivatives(fmu: &Fmu, numbers: [f64; 3], count: usize) {
    let rows = fmu.importer_rows("derivatives", numbers);
    assert_eq!(rows.len(), count);
    for row in rows {
        assert_eq!(row[0], row[1], "directional and adjoint");
        assert!((row[0] - row[2]).abs() < 2e-6 * (1.0 + row[0].abs()), "{row:?}");
    }
}

/// Checks the derivatives of rates in Continuous-Time Mode, where violated constraints decay.
fn check_rate_derivatives(fmu: &Fmu, states: usize) {
    let rows = fmu.importer_rows("rate-derivatives", [0.0; 3]);
    assert_eq!(rows.len(), states * states);
    for row in rows {
        assert!((row[0] - row[2]).abs() < 2e-6 * (1.0 + row[0].abs()), "{row:?}");
    }
}

#[test]
fn four_bar_has_derivatives() {
    let values = set_option_arguments(FOUR_BAR);
    let Some(fmu) =
        Fmu::new("four_bar_derivatives", &[&["../../models/src/four_bar.rs"], &values[..]].concat())
    else {
        return;
    };
    assert!(fmu.description.contains("providesAdjointDerivatives=\"true\""), "{}", fmu.description);
    // Rates of six states and two energies, by six states, one input and six parameters.
    check_derivatives(&fmu, [1.0, 6.0, 2.0], 8 * 13);
    check_rate_derivatives(&fmu, 6);
}

/// A disk that rolls has constraints of velocities and quaternions or angles.
#[test]
fn rolling_disk_rate_derivatives_match_differences() {
    let values =
        set_option_arguments(&["g=9.81", "m=2", "radius=0.4", "q.lean=0.3", "v.roll=6", "v.heading=1"]);
    let Some(fmu) = Fmu::new("rolling_disk", &[&["../../models/src/rolling_disk.rs"], &values[..]].concat())
    else {
        return;
    };
    let states = fmu.description.matches("initial=\"approx\"").count();
    check_rate_derivatives(&fmu, states);
}

/// Mechanisms with contacts have central differences; here the contact is open.
#[test]
fn fmu_with_contacts_has_directional_derivatives() {
    let values = set_option_arguments(&["bounce=0.7", "q.height=1.1", "v.height=-2"]);
    let arguments = [&["tests/fmu/mechanisms.rs", "--struct", "BouncingBall"], &values[..]].concat();
    let Some(fmu) = Fmu::new("ball_derivatives", &arguments) else { return };
    // Rates of two states and two energies, by two states and one parameter.
    check_derivatives(&fmu, [0.0, 1.0, 2.0], 4 * 3);
}

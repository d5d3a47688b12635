//! Checks that pictures are well-formed SVG with names and units. If `PICTURES` names a folder, they are
//! written there for inspection.

#[path = "support/transport.rs"]
mod transport;

use linkwork_design::{StateSpace, TransferFunction, picture};
use nalgebra::dmatrix;
use transport::jet_transport;

fn check_and_save_picture(name: &str, svg: &str) {
    if let Ok(folder) = std::env::var("PICTURES") {
        std::fs::write(format!("{folder}/{name}.svg"), svg).unwrap();
    }
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name}");
}

#[test]
fn all_pictures_are_well_formed() {
    let transport = jet_transport();
    let yaw = transport.channel("yaw rate", "rudder").unwrap();
    let grid = yaw.natural_frequencies(400).unwrap();
    let response = yaw.frequency_response("yaw rate", "rudder", &grid).unwrap();
    let bode = picture::bode(&response).unwrap();
    check_and_save_picture("bode", &bode);
    for words in ["from rudder to yaw rate", "frequency, rad/s", "magnitude, dB", "phase, deg"] {
        assert!(bode.contains(words), "{words}");
    }
    let open = TransferFunction::new([6.0], [1.0, 2.0, 3.0, 4.0]).unwrap().state_space().unwrap();
    let response = open.frequency_response(0, 0, &open.natural_frequencies(400).unwrap()).unwrap();
    check_and_save_picture("nyquist", &picture::nyquist(&response).unwrap());
    let turned = yaw.series(&StateSpace::gain(dmatrix![-1.0]).unwrap()).unwrap();
    let locus = turned.root_locus(&turned.locus_gains().unwrap()).unwrap();
    check_and_save_picture("root_locus", &picture::root_locus(&locus).unwrap());
    check_and_save_picture("poles_and_zeros", &picture::poles_and_zeros(&yaw).unwrap());
    let held = yaw.discretize(0.5, linkwork_design::Hold::Zero).unwrap();
    check_and_save_picture("poles_and_zeros_discrete", &picture::poles_and_zeros(&held).unwrap());
    let motion =
        transport.initial_response(&[0.05, 0.0, 0.0, 0.0], &transport.times(60.0, 601).unwrap()).unwrap();
    let history = picture::history(&motion, "After a sideslip of 0.05 rad").unwrap();
    assert!(history.contains("bank, rad"));
    check_and_save_picture("history", &history);
    let modes = picture::modes(&transport.modes().unwrap()).unwrap();
    assert!(modes.contains("bank: takes part") && modes.contains("animateTransform"));
    check_and_save_picture("modes", &modes);
    let all = transport.modes().unwrap();
    let named =
        picture::named_modes(&[("spiral", &all[0]), ("roll", &all[1]), ("Dutch roll", &all[2])]).unwrap();
    assert!(named.contains("Dutch roll: -0.03294") && named.contains("bank: takes part"));
    assert!(picture::named_modes(&[]).is_err());
    // The curves of an integrator leave the Nyquist diagram, and are clipped at its border.
    let integrator = TransferFunction::new([2.0], [1.0, 3.0, 2.0, 0.0]).unwrap().state_space().unwrap();
    let response =
        integrator.frequency_response(0, 0, &integrator.natural_frequencies(300).unwrap()).unwrap();
    check_and_save_picture("nyquist_integrator", &picture::nyquist(&response).unwrap());
    // Logarithmic axis, with a zero among the values, and a marked instant.
    let falls = (0..500).map(|k| (0.1 * f64::from(k), (-f64::from(k) / 20.0).exp())).chain([(50.0, 0.0)]);
    let chart = picture::Chart::over_time("Decay", "error, m").logarithmic().curve("falls", falls);
    let svg = chart.instant(20.0, "caught").svg().unwrap();
    for word in ["time, s", "error, m", "falls", "caught", "10⁻⁶"] {
        assert!(svg.contains(word), "{word}");
    }
    check_and_save_picture("chart", &svg);
    assert!(picture::Chart::over_time("", "").curve("", [(0.0, f64::NAN)]).svg().is_err());
}

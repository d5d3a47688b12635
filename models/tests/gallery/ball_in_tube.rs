use crate::testing::{assert_matrix_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::BallInTube;

const B: BallInTube = BallInTube { g: 9.81, mass: 0.046, radius: 0.021, tube: 0.054 };

#[test]
fn ball_in_tube_rises_again() -> Result<(), Error> {
    let (around, sinking, spin) = (30.0, -0.2, 4.0);
    let (reach, r) = (B.tube - B.radius, B.radius);
    let q = [reach, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let v = [0.0, around * reach, sinking, spin, sinking / r, -around * reach / r];
    let frequency = (2.0_f64 / 7.0).sqrt() * around;
    let middle = -2.5 * B.g / (around * around) - r * spin / around;
    let run = simulate(&B).from(q, v).method(precise_integrator()).duration(1.0).sample_every(0.1);
    for sample in run {
        let Sample { t, q, .. } = sample?;
        let ((s, c), (sz, cz)) = ((around * t).sin_cos(), (frequency * t).sin_cos());
        let height = middle * (1.0 - cz) + sinking / frequency * sz;
        assert_matrix_close(q.fixed_rows::<3>(0).into_owned(), [reach * c, reach * s, height].into(), 1e-8);
    }
    Ok(())
}

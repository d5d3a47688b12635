//! Integration methods on the problems of `precision`, a line for each tolerance: problem, method, tolerance,
//! evaluations of the accelerations and of their derivatives, seconds, then the final configuration.
//! `peers/run integrators` compares it.

use linkwork::integrate::{DormandPrince, DormandPrince8, Error, Rodas};
use linkwork_benches::precision::{Found, PROBLEMS, solve_problem};

fn print(problem: usize, method: &str, tolerance: f64, found: Result<Found, Error>) {
    match found {
        Ok(Found { q, evaluations, derivatives, seconds }) => {
            let q: Vec<String> = q.iter().map(|x| format!("{x:e}")).collect();
            println!(
                "{problem} {method} {tolerance:e} {evaluations} {derivatives} {seconds:e} {}",
                q.join(" ")
            );
        }
        Err(error) => println!("{problem} {method} {tolerance:e} failed {error}"),
    }
}

fn main() {
    for problem in 0..PROBLEMS.len() {
        for power in [3, 5, 7, 9, 11] {
            let tolerance = 10f64.powi(-power);
            let rodas = Rodas::new().tolerance(tolerance, tolerance);
            let explicit = DormandPrince::new().tolerance(tolerance, tolerance);
            let high = DormandPrince8::new().tolerance(tolerance, tolerance);
            print(problem, "DormandPrince", tolerance, solve_problem(problem, explicit));
            print(problem, "DormandPrince8", tolerance, solve_problem(problem, high));
            if power <= 9 {
                print(problem, "Rodas", tolerance, solve_problem(problem, rodas));
            }
        }
    }
}

//! Integration methods on the problems of `precision`, a line for each tolerance: problem, method, tolerance,
//! evaluations of the accelerations and of their derivatives, seconds, then the final configuration.
//! `peers/run integrators` compares it.

use linkwork::integrate::{DormandPrince, DormandPrince8, Error, Rodas};
use linkwork_benches::precision::{IntegrationResult, PROBLEMS, solve_problem};

fn print_result_row(problem: usize, method: &str, tolerance: f64, found: Result<IntegrationResult, Error>) {
    match found {
        Ok(IntegrationResult { q, evaluations, derivatives, seconds }) => {
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
            print_result_row(problem, "DormandPrince", tolerance, solve_problem(problem, explicit));
            print_result_row(problem, "DormandPrince8", tolerance, solve_problem(problem, high));
            if power <= 9 {
                print_result_row(problem, "Rodas", tolerance, solve_problem(problem, rodas));
            }
        }
    }
}
